"""A recording that the disk refuses."""

import errno

import pytest

pytest.importorskip("rosbags")

from dynastar.errors import DataError
from dynastar.ros.bag import BagWriter
from recordings import ODOMETRY, odometry

FULL = OSError(errno.ENOSPC, "No space left on device")


def refuse(*given):
    raise FULL


@pytest.mark.parametrize("refused", ["open", "write", "close"])
def test_a_full_disk_names_the_recording_and_leaves_nothing(tmp_path, monkeypatch, refused):
    for method in (refused, "abort"):
        monkeypatch.setattr(f"rosbags.rosbag2.Writer.{method}", refuse)
    said = rf"{tmp_path / 'bag'}: cannot be written \(No space left on device\)"
    with pytest.raises(DataError, match=said), BagWriter(tmp_path / "bag") as bag:
        bag.write("/odom", ODOMETRY, 0.0, odometry(0))
    assert list(tmp_path.iterdir()) == []


def test_a_recording_in_place_stays_and_the_node_is_told(tmp_path, monkeypatch):
    bag = BagWriter(tmp_path / "bag", aside=False)
    monkeypatch.setattr(bag._writer, "write", refuse)
    with pytest.raises(OSError, match="No space"):
        bag.write("/odom", ODOMETRY, 0.0, odometry(0))
    bag.close()
    assert (tmp_path / "bag" / "metadata.yaml").is_file()
