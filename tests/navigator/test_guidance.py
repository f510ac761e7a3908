import math

import numpy as np
import pytest

from dynastar.clearance import DistanceField, lower_bounds
from dynastar.dwa.cost_to_go import value_at
from dynastar.navigator.guidance import Guidance, Lead
from dynastar.path import Path
from dynastar.perception import LocalMap, LocalMapConfig, MovingObstacle, PredictionConfig
from dynastar.perception.prediction import predict

CELL, MARGIN, COMFORT = 0.05, 0.3, 0.25
NOBODY = predict([], PredictionConfig(), (0.0, 0.1, 40))
MEETING = (0.0, 0.1, 1.0, 0.3)


class Guide:
    """Guidance over a local map round (5, 5), low corner at the origin."""

    def __init__(self):
        self.local_map = LocalMap(LocalMapConfig(resolution=CELL, size=10.0))
        self.local_map.follow(5.0, 5.0)
        self.n = len(self.local_map.states)
        self.guidance = Guidance(self.n, CELL, MARGIN, COMFORT)
        self.occupied = np.zeros((self.n, self.n), bool)

    def wall(self, x0, y0, x1, y1):
        x, y = self.local_map.origin
        r0, r1 = round((y0 - y) / CELL), round((y1 - y) / CELL)
        c0, c1 = round((x0 - x) / CELL), round((x1 - x) / CELL)
        self.occupied[r0:r1, c0:c1] = True

    def update(self, points, here, s=0.0, people=NOBODY):
        lead = Lead(Path(np.array(points, float)), s)
        free = (~self.occupied).view(np.uint8)
        obstacles = DistanceField(lower_bounds(free, CELL), *self.local_map.origin, CELL)
        return self.guidance.update(obstacles, lead, here, people, MEETING)


@pytest.mark.parametrize("goal", [(7.0, 5.0), (14.0, 5.0), (5.0, 40.0), (8.0, 8.0), (-20.0, -20.0)])
def test_on_an_empty_map_the_cost_to_go_is_what_is_left_of_the_path(goal):
    guide = Guide()
    guide.update([(5.0, 5.0), goal], (5.0, 5.0))
    length = math.dist((5.0, 5.0), goal)
    assert guide.guidance.reachable
    assert guide.guidance.cost_to_go(5.0, 5.0) == pytest.approx(length, rel=0.05, abs=0.15)


def test_it_falls_by_what_is_driven():
    guide = Guide()
    values = []
    for k in range(20):
        guide.update([(5.0, 5.0), (5.0, 30.0)], (5.0, 5.0 + 0.1 * k), s=0.1 * k)
        values.append(guide.guidance.cost_to_go(5.0, 5.0 + 0.1 * k))
    # The line followed before is favoured: up to 15 % less to go while it is on the local map.
    assert 1.9 - 0.2 < values[0] - values[-1] < 1.9 + 0.15 * 5.0
    assert np.diff(values).max() < 0.15


def test_a_wall_off_the_path_is_led_round():
    guide = Guide()
    guide.wall(6.5, 3.5, 6.7, 6.0)
    _, to_go = guide.update([(5.0, 5.0), (8.5, 5.0)], (5.0, 5.0))
    assert guide.guidance.reachable
    shortest = math.dist((5.0, 5.0), (6.6, 6.35)) + math.dist((6.6, 6.35), (8.5, 5.0))
    assert shortest - 0.3 < value_at(to_go, 5.0, 5.0) < 2.0 * shortest
    gaps = np.hypot(
        np.maximum(
            np.maximum(6.5 - guide.guidance.line[:, 0], guide.guidance.line[:, 0] - 6.7), 0.0
        ),
        np.maximum(
            np.maximum(3.5 - guide.guidance.line[:, 1], guide.guidance.line[:, 1] - 6.0), 0.0
        ),
    )
    assert gaps.min() > MARGIN - 2 * CELL


def test_no_way_within_the_local_map_is_said():
    guide = Guide()
    for box in (
        (4.0, 4.0, 6.0, 4.1),
        (4.0, 5.9, 6.0, 6.0),
        (4.0, 4.0, 4.1, 6.0),
        (5.9, 4.0, 6.0, 6.0),
    ):
        guide.wall(*box)
    _, to_go = guide.update([(5.0, 5.0), (8.5, 5.0)], (5.0, 5.0))
    assert not guide.guidance.reachable
    assert math.isfinite(value_at(to_go, 5.0, 5.0))


def test_who_stands_too_close_to_something_is_led_out():
    guide = Guide()
    guide.wall(4.0, 4.0, 8.0, 4.8)  # 0.2 m beside the robot, which needs 0.3
    _, to_go = guide.update([(5.0, 5.0), (8.5, 5.5)], (5.0, 5.0))
    assert guide.guidance.reachable
    assert value_at(to_go, 5.0, 5.15) < value_at(to_go, 5.0, 5.0)


def test_the_line_starts_at_the_robot_and_descends():
    guide = Guide()
    _, to_go = guide.update([(5.0, 5.0), (9.0, 7.0)], (5.0, 5.0))
    line = guide.guidance.line
    assert line[0].tolist() == [5.0, 5.0]
    assert np.hypot(*np.diff(line, axis=0).T) == pytest.approx(guide.guidance.spacing)
    values = [value_at(to_go, x, y) for x, y in line]
    assert (np.diff(values) < 0.0).all()


def test_who_crosses_the_way_makes_it_longer():
    ways = []
    for people in (
        NOBODY,
        predict([MovingObstacle(7.0, 5.0, 0.0, 0.0, 0.4)], PredictionConfig(), (0.0, 0.1, 40)),
    ):
        guide = Guide()
        guide.update([(5.0, 5.0), (9.0, 5.0)], (5.0, 5.0), people=people)
        ways.append(guide.guidance.cost_to_go(5.0, 5.0))
    assert ways[1] > ways[0] + 0.05
