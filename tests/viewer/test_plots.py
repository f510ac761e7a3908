"""Plots of grids, plans, scans and episodes: what is drawn, where, and into which axes."""

import math
import subprocess
import sys

import numpy as np
import pytest
from matplotlib import pyplot

from dynastar import GridFrame, LaserScan, OccupancyGrid, Path, Plan, Pose2D
from dynastar.errors import MissingPackage
from dynastar.extras import how_to_install
from episodes import episode

GRID = OccupancyGrid(np.eye(8, dtype=bool), GridFrame(0.5, 1.0, 2.0))
WAY = Path([(1.5, 2.5), (3.0, 2.5), (3.0, 4.0)])
PLAN = Plan("improved", WAY, WAY, np.zeros((3, 2), np.int32), 3.0, 9, None, 1.0, 0.1, 0.0)
SCAN = LaserScan(0.0, [1.0, 5.0, 2.0, 0.0], 0.0, math.pi / 2, 0.1, 5.0, Pose2D(0.5, 0.0))
THINGS = GRID, PLAN, SCAN, episode(20)


@pytest.fixture(autouse=True)
def _closed():
    yield
    pyplot.close("all")


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: type(thing).__name__)
def test_axes_are_in_metres_and_equal(thing):
    axes = thing.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x, m", "y, m")
    assert axes.get_aspect() == 1.0
    assert axes.figure.number in pyplot.get_fignums()
    axes.figure.canvas.draw()


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: type(thing).__name__)
def test_axes_that_are_given_are_used_and_nothing_else(thing):
    figure, (left, right) = pyplot.subplots(1, 2)
    assert thing.plot(left) is left
    assert figure.axes == [left, right]
    assert not right.has_data()


def test_a_plan_on_its_map_explains_both():
    axes = PLAN.plot(GRID.plot())
    assert labels(axes) == ["mapped obstacle", "grid path, 3.00 m", "smoothed path, 3.00 m"]
    low, high = axes.get_xlim()
    assert (low, high) == (1.0, 5.0)
    assert any(np.array_equal(line.get_xydata(), WAY.points) for line in axes.lines)


def test_a_scan_lies_where_the_robot_is():
    axes = SCAN.plot(pose=Pose2D(1.0, 2.0, math.pi / 2))
    hits, lidar = axes.lines
    assert hits.get_xydata() == pytest.approx(np.array([(1.0, 3.5), (1.0, 0.5)]))
    assert lidar.get_xydata() == pytest.approx(np.array([(1.0, 2.5)]))
    free = axes.patches[0].get_path().vertices
    assert (-4.0, 2.5) in [tuple(corner) for corner in free.round(6)]  # the beam without a hit
    assert labels(axes)[0] == "hits (2 of 4 beams)"


def test_an_episode_has_a_bar_of_speeds():
    axes = episode(20).plot()
    assert [other.get_ylabel() for other in axes.figure.axes] == ["y, m", "speed, m/s"]


def test_without_matplotlib_one_error_says_what_to_install():
    code = "import sys; sys.modules['matplotlib'] = None; import dynastar as d; "
    made = "d.OccupancyGrid([[0]]).plot()"
    ran = subprocess.run(
        [sys.executable, "-c", code + made], capture_output=True, text=True, check=False
    )
    last = ran.stderr.splitlines()[-1]
    assert MissingPackage.__name__ in last
    assert how_to_install("viewer") in last


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: type(thing).__name__)
def test_new_figures_hold_their_legends(thing):
    figure = thing.plot().figure
    figure.canvas.draw()
    box = figure.axes[0].get_legend().get_window_extent()
    assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width
    assert 0.0 <= box.y0 < box.y1 <= figure.bbox.height
