import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from dynastar.episode import Episode, PlanRecord
from dynastar.errors import InputError
from dynastar.footprint import box
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.path import Path as Line
from dynastar.terminal import printable
from dynastar.viewer.animation import animate_episode
from dynastar.viewer.commands import draw_commands
from dynastar.viewer.figure import draw_episode, draw_map, draw_plan, draw_world
from dynastar.viewer.panels import draw_driven
from dynastar.viewer.sheet import save
from episodes import episode

Cut = Callable[[int], Episode]


def shown(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def near(image: np.ndarray, colour: str, within: int = 30) -> int:
    """How many pixels have about this colour."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return int((np.abs(image - wanted).sum(axis=2) < within).sum())


def test_a_picture_has_all_that_happened(office: Episode, tmp_path: Path):
    path = tmp_path / "new" / "office.png"
    draw_episode(office, path)
    image = shown(path)
    assert image.shape[1] == 1440
    for colour in ("#30343b", "#b4b7bd", "#009e73", "#dbe9f7", "#0a3d8f", "#1f78c8"):
        assert near(image, colour) > 20, colour
    assert list(path.parent.iterdir()) == [path]


def test_a_contact_is_red(office: Episode, tmp_path: Path):
    draw_episode(office, tmp_path / "fine.png")
    touched = replace(office, outcome="contact", contact="moving", reason="touched a box")
    draw_episode(touched, tmp_path / "contact.png")
    assert near(shown(tmp_path / "fine.png"), "#e3001b") == 0
    assert near(shown(tmp_path / "contact.png"), "#e3001b") > 100


@pytest.mark.parametrize("suffix", [".svg", ".pdf"])
def test_other_formats(office: Episode, tmp_path: Path, suffix: str):
    draw_episode(office, tmp_path / f"office{suffix}")
    begin = (tmp_path / f"office{suffix}").read_bytes()[:200]
    assert b"<?xml" in begin or b"%PDF" in begin


def test_a_wrong_suffix_is_said_and_nothing_left(office: Episode, tmp_path: Path):
    with pytest.raises(InputError, match=r"bmp.*\.png, \.svg, \.pdf"):
        draw_episode(office, tmp_path / "office.bmp")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("ticks", [0, 1, 2])
def test_the_shortest_missions(cut: Cut, tmp_path: Path, ticks: int):
    short = replace(cut(ticks), plans=(), outcome="blocked", reason="no way")
    draw_episode(short, tmp_path / "short.png")
    assert (tmp_path / "short.png").stat().st_size > 10_000


def test_polygon_footprint_goals_and_movers_that_vanish(office: Episode, tmp_path: Path):
    movers = office.movers.copy()
    movers[100:300, 0] = np.nan
    movers[:, 1] = np.nan
    goals = np.array([[7.4, 11.5], [25.0, 21.5]])
    footprint = box(0.8, 0.5).vertices
    draw_episode(
        replace(office, movers=movers, goals=goals, footprint=footprint, radius=0.48),
        tmp_path / "p.png",
    )


def test_many_replans_that_change_nothing(office: Episode, tmp_path: Path):
    again = [office.plans[0]._replace(stamp=float(k)) for k in range(60)]
    empty = PlanRecord(61.0, "none", np.empty((0, 2)), np.empty((0, 2), dtype=np.int32))
    draw_episode(replace(office, plans=(*again, empty)), tmp_path / "many.png")
    assert near(shown(tmp_path / "many.png"), "#5ab4e5", 10) < 400  # one dash in the legend


@pytest.mark.parametrize(("rows", "columns"), [(6, 200), (200, 6), (1, 1)])
def test_maps_of_any_shape(office: Episode, tmp_path: Path, rows: int, columns: int):
    grid = OccupancyGrid(np.zeros((rows, columns), dtype=np.int8), GridFrame(0.5))
    draw_episode(replace(office, grid=grid, plans=office.plans[:1]), tmp_path / "shape.png")


def test_the_map_lies_where_its_origin_and_yaw_put_it():
    values = np.zeros((10, 10), dtype=np.int8)
    values[0, 8:] = 100  # yawed by a quarter turn: at x -1 to 0, y 8 to 10
    figure = Figure(figsize=(2, 2), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    draw_map(OccupancyGrid(values, GridFrame(1.0, 0.0, 0.0, np.pi / 2)), axes)
    axes.set_axis_off()
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba())[:, :, :3].astype(int)
    dark = np.argwhere(image.sum(axis=2) < 300) / 20.0  # of 10 m on 200 pixels
    assert dark.min(axis=0) == pytest.approx((0.0, 9.0), abs=0.2)
    assert dark.max(axis=0) == pytest.approx((2.0, 10.0), abs=0.2)


def test_a_plan_with_its_explored_cells(office: Episode, tmp_path: Path):
    points = office.plans[0].points
    plan = SimpleNamespace(
        planner="improved",
        path=Line(points),
        grid_path=Line(points[[0, 1, 1, 2, 3, 4, 5]]),
        explored=office.plans[0].explored,
        expanded=len(office.plans[0].explored),
        time_ms=1.5,
    )
    draw_plan(office.grid, plan, tmp_path / "plan.png")  # type: ignore[arg-type]
    assert near(shown(tmp_path / "plan.png"), "#dbe9f7") > 1000
    plan.explored = None
    draw_plan(office.grid, plan, tmp_path / "plain.png")  # type: ignore[arg-type]


def test_a_large_map_takes_hardly_longer_than_a_small_one(office: Episode, tmp_path: Path):
    def seconds(episode: Episode) -> float:
        began = time.process_time()
        draw_episode(episode, tmp_path / "drawn.png")
        return time.process_time() - began

    values = np.zeros((2000, 2000), dtype=np.int8)
    values[::40] = 100
    large = replace(office, grid=OccupancyGrid(values, GridFrame(0.02)))
    seconds(office)
    assert seconds(large) < 10.0 * seconds(office)


def test_no_global_state_of_matplotlib(
    office: Episode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.delitem(sys.modules, "matplotlib.pyplot", raising=False)
    draw_episode(office, tmp_path / "office.png")
    assert "matplotlib.pyplot" not in sys.modules


@pytest.mark.parametrize("name", [r"$\frac{1}{$", r"\$a$b$", "a\x1b[2J\x00\n\u202eb", "$$"])
def test_names_are_drawn_as_they_are(name: str, tmp_path: Path):
    one = episode(plans=1)
    one = replace(
        one, robot=name, outcome=name, reason=name, contact=name,
        scenario={**one.scenario, "name": name},
    )  # fmt: skip
    figure = draw_episode(one, tmp_path / "a.svg")
    title = max(figure.texts, key=lambda text: text.get_fontsize())
    assert title.get_text().replace(r"\$", "$").startswith(printable(name))
    assert "\x1b" not in (tmp_path / "a.svg").read_text(encoding="utf-8")
    animate_episode(one, tmp_path / "a.gif")
    draw_world(one.grid, tmp_path / "b.png", name)
    save(draw_commands(one.trajectory.times, {name: one.commands}), tmp_path / "c.png")
    save(draw_driven(one), tmp_path / "d.png")
