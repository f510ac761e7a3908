import math

import numpy as np
import pytest

from dynastar.clearance import lower_bounds
from dynastar.field import Field
from dynastar.guidance import Encounter, Guidance, PathTarget
from dynastar.guidance.guidance import COARSENING
from dynastar.path import Path
from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import Times, predict

CELL, SIDE, MARGIN, COMFORT = 0.05, 200, 0.3, 0.25  # 10 x 10 m, from (0, 0)
HERE = 5.0, 5.0
TIMES = Times(0.0, 0.1, 40)
NOTHING = predict([], PredictionConfig(), TIMES)


class Case:
    """Guidance over a local map with walls, for a robot at (5, 5)."""

    def __init__(self, *walls, keep_to_path=False):
        self.guidance = Guidance(SIDE, CELL, MARGIN, COMFORT, keep_to_path)
        free = np.ones((SIDE, SIDE), np.uint8)
        for x0, y0, x1, y1 in np.round(np.array(walls) / CELL).astype(int).reshape(-1, 4):
            free[y0:y1, x0:x1] = 0
        self.obstacles = Field(lower_bounds(free, CELL), 0.0, 0.0, CELL)
        self.closed = np.zeros((SIDE, SIDE), np.bool_)

    def guide(self, points, here=HERE, s=0.0, moving=NOTHING, ahead=math.inf):
        target = PathTarget(Path(np.array(points, float)), s, ahead)
        encounter = Encounter(*here, 1.0, 0.3, TIMES.step)
        return self.guidance.update(self.obstacles, self.closed, target, moving, encounter)


@pytest.mark.parametrize("goal", [(7.0, 5.0), (14.0, 5.0), (5.0, 40.0), (8.0, 8.0), (-20.0, -20.0)])
def test_on_an_empty_map_the_cost_to_go_is_what_is_left_of_the_path(goal):
    guide = Case().guide([HERE, goal])
    assert guide.reachable
    assert guide.cost_at(*HERE) == pytest.approx(math.dist(HERE, goal), rel=0.05, abs=0.15)


def test_no_way_leads_through_what_is_closed_to_plans_but_for_the_path():
    case = Case((6.5, 0.0, 6.7, 4.5), (6.5, 5.5, 6.7, 8.5))  # a gap of 1 m, and a way round
    through, round_it = [HERE, (8.5, 5.0)], [HERE, (6.0, 9.25), (7.2, 9.25), (8.5, 5.0)]
    assert case.guide(round_it).cost_at(*HERE) < 6.0
    case.closed[90:110, 128:136] = True
    assert case.guide(round_it).cost_at(*HERE) > 9.0
    assert case.guide(through).cost_at(*HERE) < 6.0


def test_it_falls_by_what_is_driven():
    case, values = Case(), []
    for k in range(20):
        here = 5.0, 5.0 + 0.1 * k
        guide = case.guide([HERE, (5.0, 30.0)], here, 0.1 * k)
        values.append(guide.cost_at(*here))
    assert values[0] - values[-1] == pytest.approx(1.9, abs=0.15)
    assert np.diff(values).max() < 0.15


def test_a_wall_off_the_path_is_led_round():
    guide = Case((6.5, 3.5, 6.7, 6.0)).guide([HERE, (8.5, 5.0)])
    assert guide.reachable
    shortest = math.dist(HERE, (6.6, 6.35)) + math.dist((6.6, 6.35), (8.5, 5.0))
    assert shortest - 0.3 < guide.cost_at(*HERE) < 2.0 * shortest
    x, y = guide.line.T
    across = np.maximum(np.maximum(6.5 - x, x - 6.7), 0.0)
    along = np.maximum(np.maximum(3.5 - y, y - 6.0), 0.0)
    assert np.hypot(across, along).min() > MARGIN - 2 * CELL


def test_no_way_within_the_local_map_is_said():
    box = (4.0, 4.0, 6.0, 4.1), (4.0, 5.9, 6.0, 6.0), (4.0, 4.0, 4.1, 6.0), (5.9, 4.0, 6.0, 6.0)
    guide = Case(*box).guide([HERE, (8.5, 5.0)])
    assert not guide.reachable
    assert math.isfinite(guide.cost_at(*HERE))


def test_a_robot_too_close_to_an_obstacle_is_led_away_from_it():
    case = Case((4.0, 4.0, 8.0, 4.8))  # 0.2 m beside the robot, which needs 0.3
    guide = case.guide([HERE, (8.5, 5.5)])
    assert guide.reachable
    assert guide.cost_at(5.0, 5.15) < guide.cost_at(*HERE)


def test_the_line_starts_at_the_robot_and_descends():
    case = Case()
    guide = case.guide([HERE, (9.0, 7.0)])
    assert tuple(guide.line[0]) == HERE
    assert case.guidance.resolution == pytest.approx(COARSENING * CELL)
    assert np.hypot(*np.diff(guide.line, axis=0).T) == pytest.approx(case.guidance.resolution)
    assert (np.diff([guide.cost_at(x, y) for x, y in guide.line]) < 0.0).all()


def test_a_moving_obstacle_on_the_way_makes_it_longer():
    ahead = [MovingObstacle(7.0, 5.0, 0.0, 0.0, 0.4)]
    free, met = (
        Case().guide([HERE, (9.0, 5.0)], moving=moving).cost_at(*HERE)
        for moving in (NOTHING, predict(ahead, PredictionConfig(), TIMES))
    )
    assert met > free + 0.05


def test_a_path_given_by_the_user_is_kept_to_and_seen_as_far_as_its_span():
    points = [HERE, (5.0, 8.0), (8.0, 8.0), (8.0, 5.0)]  # a planned one would be cut across
    planned, given = Case().guide(points), Case().guide(points, ahead=20.0)
    short = Case().guide(points, ahead=2.0)
    assert planned.cost_at(*HERE) == pytest.approx(3.0, abs=0.2)
    assert given.cost_at(*HERE) > 6.0
    assert given.line[25, 1] > 7.0 > planned.line[25, 1]
    assert short.cost_at(*HERE) == pytest.approx(9.0, abs=0.4)  # 2 m, and the 7 m that are left
    assert short.cost_at(5.0, 7.0) < short.cost_at(*HERE)


def test_distances_to_the_path_are_computed_where_it_is_kept_to():
    points = [HERE, (9.0, 5.0)]
    case = Case((2.0, 2.0, 2.5, 2.5))
    assert case.guide(points).distance_to_path is case.obstacles  # not needed
    for guide in (case.guide(points, ahead=5.0), Case(keep_to_path=True).guide(points)):
        field = guide.distance_to_path
        assert field.resolution == pytest.approx(COARSENING * CELL)
        for row, column in ((50, 70), (60, 70), (20, 90), (52, 40)):
            x, y = (column + 0.5) * field.resolution, (row + 0.5) * field.resolution
            true = math.hypot(max(5.0 - x, x - 9.0, 0.0), y - 5.0)
            assert field.values[row, column] == pytest.approx(true, abs=0.1 + 0.03 * true)


def test_a_path_whose_end_is_off_the_map_counts_from_where_it_leaves():
    guide = Case().guide([HERE, (9.0, 5.0), (9.0, 30.0)])
    assert guide.cost_at(8.9, 9.0) == pytest.approx(21.0, abs=0.3)
