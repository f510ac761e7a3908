"""Recordings that were cut off: read as far as they go, whatever wrote and ended them."""

import os
import shutil
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from dynastar.cli import main
from dynastar.errors import DataError, DynastarWarning
from dynastar.ros.bag import BagReader, _types
from recordings import ODOMETRY, foreign, odometry

MESSAGES = 200


def by_rosbags(folder, plugin, compressed=False):
    """A recording of MESSAGES messages, a second apart; its file."""
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if compressed:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection("/odom", ODOMETRY, typestore=_types())
        for k in range(MESSAGES):
            writer.write(
                connection, 10**9 * (100 + k), _types().serialize_cdr(odometry(k), ODOMETRY)
            )
    return next(file for file in folder.iterdir() if file.suffix in (".mcap", ".db3"))


def by_mcap(folder, compression):
    """The same by the mcap library, in chunks of about 30 messages."""
    module = pytest.importorskip("mcap.writer")
    folder.mkdir()
    with (folder / "a.mcap").open("wb") as file:
        writer = module.Writer(
            file, chunk_size=30_000, compression=module.CompressionType[compression]
        )
        writer.start("ros2", "test")
        schema = writer.register_schema(ODOMETRY, "ros2msg", b"")
        channel = writer.register_channel("/odom", "cdr", schema)
        for k in range(MESSAGES):
            data = bytes(_types().serialize_cdr(odometry(k), ODOMETRY))
            writer.add_message(channel, 10**9 * (100 + k), data, 10**9 * (100 + k))
        writer.finish()
    return folder / "a.mcap"


WRITERS = {
    "rosbags-mcap": lambda folder: by_rosbags(folder, StoragePlugin.MCAP),
    "rosbags-zstd": lambda folder: by_rosbags(folder, StoragePlugin.MCAP, True),
    "rosbags-db3": lambda folder: by_rosbags(folder, StoragePlugin.SQLITE3),
    "mcap-none": lambda folder: by_mcap(folder, "NONE"),
    "mcap-lz4": lambda folder: by_mcap(folder, "LZ4"),
    "mcap-zstd": lambda folder: by_mcap(folder, "ZSTD"),
}


def read(path):
    """The numbers of the messages that are read."""
    reader = BagReader(path)
    assert reader.topics == {"/odom": ODOMETRY}
    found = list(reader.messages({"/odom"}))
    reader.close()
    numbers = [round(one.message.pose.pose.position.x) for one in found]
    assert [one.time for one in found] == pytest.approx([100.0 + k for k in numbers])
    names = [one.message.child_frame_id for one in found]
    assert names == [odometry(k).child_frame_id for k in numbers]
    return numbers


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # rosbags' files
@pytest.mark.parametrize("writer", WRITERS)
def test_a_file_that_was_cut_off_is_read_up_to_there(tmp_path, writer):
    file = WRITERS[writer](tmp_path / "bag")
    whole, counts = file.read_bytes(), []
    for tenths in range(11):
        (tmp_path / "bag" / "metadata.yaml").unlink(missing_ok=True)  # is written at the end
        file.write_bytes(whole[: max(len(whole) * tenths // 10 - 1, 100)])
        path = file if tenths % 2 else file.parent
        try:
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always", DynastarWarning)
                numbers = read(path)
        except DataError as error:
            assert "not a recording that can be read" in str(error)  # noqa: PT017
            counts.append(0)
            continue
        assert [one.category for one in told] == [DynastarWarning]
        assert numbers == list(range(len(numbers)))
        words = f"{len(numbers) - 1:.3f} s after its first message, {len(numbers)} messages"
        assert words in str(told[0].message)
        counts.append(len(numbers))
    assert counts == sorted(counts)
    assert counts[-1] > 0.98 * MESSAGES
    if writer in ("rosbags-mcap", "rosbags-db3", "mcap-none"):
        assert all(count > MESSAGES * (0.1 * n - 0.15) for n, count in enumerate(counts))


def test_a_recording_in_several_files_without_its_table(tmp_path):
    for name in ("a", "b"):
        file = by_rosbags(tmp_path / name, StoragePlugin.MCAP)
        file.rename(tmp_path / f"{name}.mcap")
        shutil.rmtree(tmp_path / name)
    with pytest.warns(DynastarWarning, match="400 messages in all"):
        assert read(tmp_path) == sorted(2 * list(range(MESSAGES)))


WRITE = """
import itertools, sys
from pathlib import Path
from dynastar.ros.bag import BagWriter
from recordings import ODOMETRY, odometry
bag = BagWriter(Path(sys.argv[1]), aside=False)
for k in itertools.count():
    bag.write("/odom", ODOMETRY, 100.0 + k, odometry(k))
    print(k, flush=True)
"""
WRITE_SQLITE = """
import itertools, sqlite3, sys
from dynastar.ros.bag import _types
from recordings import ODOMETRY, odometry
database = sqlite3.connect(sys.argv[1])
database.execute("PRAGMA journal_mode = WAL")
database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, "
                 "serialization_format TEXT, offered_qos_profiles TEXT)")
database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, "
                 "timestamp INTEGER, data BLOB)")
database.execute("INSERT INTO topics VALUES (1, '/odom', ?, 'cdr', '')", (ODOMETRY,))
for k in itertools.count():
    data = bytes(_types().serialize_cdr(odometry(k), ODOMETRY))
    row = (1, 10**9 * (100 + k), data)
    database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", row)
    database.commit()
    print(k, flush=True)
"""


@pytest.mark.parametrize(
    ("script", "name"), [(WRITE, "bag"), (WRITE_SQLITE, "bag/a.db3"), (WRITE_SQLITE, "bag/b.db3")]
)
def test_what_a_process_recorded_before_it_was_killed_is_read(tmp_path, script, name):
    if script == WRITE_SQLITE:
        (tmp_path / "bag").mkdir()
    tests = str(Path(__file__).parents[1])
    paths = os.pathsep.join([tests, os.environ.get("PYTHONPATH", "")])
    process = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path / name)],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": paths},
    )
    for line in process.stdout:
        if int(line) >= 50:
            break
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()
    path = tmp_path / "bag" if "b.db3" not in name else tmp_path / name
    with pytest.warns(DynastarWarning, match="was cut off"):
        numbers = read(path)
    assert numbers == list(range(len(numbers)))
    assert len(numbers) >= 50


def test_dynastar_replay_reads_one_and_says_so_in_a_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    foreign(tmp_path / "bag", ("/map", "/scan", "/odom", "/goal_pose"))
    file = tmp_path / "bag" / "bag.mcap"
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) * 3 // 4])
    words = ["replay", "bag", "--robot", "turtlebot3_burger", "--set", "dwa.horizon=2"]
    assert main(words) == 0
    told = [line for line in capsys.readouterr().err.splitlines() if "cut off" in line]
    assert len(told) == 1
    assert told[0].startswith("dynastar: warning: bag was cut off or is damaged: it is read up to")
    file.write_bytes(whole[:60])
    assert main(words) == 2
    said = capsys.readouterr().err
    assert said.startswith("dynastar: bag: not a recording that can be read")
    assert said.count("\n") == 1
