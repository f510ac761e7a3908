from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from dynastar.episode import Episode
from dynastar.errors import InputError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.viewer.animation import animate_episode, pace
from dynastar.viewer.canvas import Canvas
from dynastar.viewer.view import View

Cut = Callable[[int], Episode]


def frames(path: Path) -> list[np.ndarray]:
    with Image.open(path) as image:
        result = []
        for number in range(image.n_frames):
            image.seek(number)
            result.append(np.asarray(image.convert("RGB")).astype(int))
        return result


def seconds(path: Path) -> float:
    with Image.open(path) as image:
        total = 0
        for number in range(image.n_frames):
            image.seek(number)
            total += image.info["duration"]
        return total / 1000.0


@given(st.integers(1, 4000), st.floats(0.02, 0.5), st.floats(2, 40), st.floats(1, 30))
def test_every_mission_fits_and_ends_with_its_last_tick(
    count: int, period: float, fps: float, longest: float
):
    shown = pace(5.0 + period * np.arange(count), fps, longest)
    assert (len(shown.ticks) - 1) * shown.frame_ms <= 1000 * longest + 1e-6
    assert shown.ticks[-1] == count - 1
    assert (np.diff(shown.ticks) >= 0).all()
    assert shown.ticks.min() >= 0
    assert shown.speedup >= 1


def test_a_short_mission_runs_at_its_own_speed():
    shown = pace(0.1 * np.arange(51), 12.0, 20.0)
    assert shown.speedup == 1
    assert len(shown.ticks) == pytest.approx(5.0 / 0.08 + 1, abs=1)


def test_the_robot_and_the_movers_move(office: Episode, tmp_path: Path):
    path = tmp_path / "office.gif"
    animate_episode(office, path, max_seconds=4.0)
    assert path.stat().st_size < 3_000_000
    assert list(tmp_path.iterdir()) == [path]
    assert seconds(path) <= 4.0 + 2.0
    pictures = frames(path)
    driven = [int((np.abs(p - (196, 60, 78)).sum(axis=2) < 20).sum()) for p in pictures]
    assert driven[-1] > 3 * driven[0]
    green = np.abs(pictures[0] - (0, 158, 115)).sum(axis=2) < 20
    assert (np.abs(pictures[-1] - (0, 158, 115)).sum(axis=2) < 20)[green].mean() < 0.9
    assert (pictures[0] == 255).all(axis=2).mean() > 0.5  # free space is white


def test_a_contact_is_crossed_out_at_the_end(office: Episode, tmp_path: Path):
    touched = replace(office, outcome="contact", contact="moving")
    animate_episode(touched, tmp_path / "contact.gif", max_seconds=1.0)
    first, *_, last = frames(tmp_path / "contact.gif")
    red = [int((np.abs(p - (227, 0, 27)).sum(axis=2) < 20).sum()) for p in (first, last)]
    assert red[0] < 20 < red[1]


def test_movers_that_vanish_and_a_mission_of_one_tick(cut: Cut, tmp_path: Path):
    one = replace(cut(1), movers=np.full((1, 4, 2), np.nan), plans=())
    animate_episode(one, tmp_path / "one.gif")
    assert len(frames(tmp_path / "one.gif")) == 1


def test_bad_input_is_said(office: Episode, cut: Cut, tmp_path: Path):
    with pytest.raises(InputError, match=r"\.gif"):
        animate_episode(office, tmp_path / "office.mp4")
    with pytest.raises(InputError, match="fps"):
        animate_episode(office, tmp_path / "office.gif", fps=0.0)
    with pytest.raises(InputError, match="no tick"):
        animate_episode(cut(0), tmp_path / "office.gif")


def test_progress_goes_to_stderr(
    office: Episode,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr("dynastar.terminal.EVERY", 0.0)  # s between lines where it is no terminal
    animate_episode(office, tmp_path / "a.gif", max_seconds=0.5)
    assert capsys.readouterr() == ("", "")
    animate_episode(office, tmp_path / "a.gif", max_seconds=0.5, progress=True)
    out, err = capsys.readouterr()
    assert out == ""
    assert "animation" in err


@pytest.mark.parametrize("yaw", [0.0, np.pi / 2, 0.6])
def test_the_map_lies_where_its_origin_and_yaw_put_it(yaw: float):
    values = np.zeros((40, 40), dtype=np.int8)
    values[30:, :10] = 100
    frame = GridFrame(0.25, 1.0, -2.0, yaw)
    canvas = Canvas(View(-15.0, -15.0, 15.0, 15.0), 300, 300, 0)
    canvas.show_map(OccupancyGrid(values, frame))
    drawn = np.asarray(canvas.reduced()).astype(int)
    rows, columns = np.nonzero(drawn.sum(axis=2) < 300)
    x, y = (columns + 0.5) / 10.0 - 15.0, 15.0 - (rows + 0.5) / 10.0
    centre = frame.to_world(35.0, 5.0)
    assert (x.mean(), y.mean()) == pytest.approx(centre, abs=0.1)
    assert len(rows) == pytest.approx(2.5 * 2.5 * 100, rel=0.1)


def test_points_and_pixels_agree():
    canvas = Canvas(View(0.0, 0.0, 10.0, 5.0), 100, 100, 20)
    assert canvas.size == (100, 90)
    assert canvas.pixels(np.array([(0.0, 5.0), (10.0, 0.0)])) == [(0.0, 40.0), (200.0, 140.0)]
