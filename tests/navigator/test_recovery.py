"""When a robot that makes no progress plans anew, and when it gives up."""

import numpy as np
import pytest

from dynastar.errors import NoPath
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.navigator.mission import Mission
from dynastar.navigator.planners import Planners
from dynastar.navigator.recovery import Recovery
from dynastar.navigator.replanning import Route
from dynastar.path import Path
from dynastar.perception import PlanningMap
from dynastar.robot import ROBOTS

CONFIG = NavigatorConfig(stuck_time=1.0, attempts=2)
PATH = Path([(0.0, 0.0), (9.0, 0.0)])


class Stage:
    """A mission to (9, 0), judged every 0.3 s, with a path or without."""

    def __init__(self):
        self.mission = Mission()
        self.mission.begin([Goal(9.0, 0.0)], "new goal")
        planning_map = PlanningMap(
            OccupancyGrid(np.zeros((100, 100), np.int8), GridFrame(0.1)), 0.1
        )
        limits = ROBOTS["turtlebot3_burger"].limits
        route = Route(Planners(planning_map, CONFIG, (0.2, 0.2)), CONFIG, limits)
        self.recovery = Recovery(self.mission, route, limits, CONFIG)
        self.route, self.now, self.refined = route, 0.0, 0

    def tick(self, x, has_path):
        self.now += 0.3
        state = RobotState(self.now, Pose2D(x, 0.0, 0.0), Twist(0.0, 0.0))
        self.route.path, self.route.error = (PATH, None) if has_path else (None, NoPath("shut"))
        if self.recovery.is_stopping:
            self.recovery.go_on(state, self._refine)
        else:
            self.recovery.judge(state, lambda x, y: 9.0 - x)
        return self.mission.state, self.mission.recoveries

    def _refine(self):
        self.refined += 1

    def recovers(self, x, has_path):
        """Stand still until the next recovery is over."""
        before = self.mission.recoveries
        for _ in range(9):
            if self.tick(x, has_path)[1] > before or self.mission.is_blocked:
                return


@pytest.fixture
def stage():
    return Stage()


@pytest.mark.parametrize("has_path", [True, False])
def test_it_gives_up_after_its_attempts_where_it_stands(stage, has_path):
    for n in (1, 2):
        stage.recovers(0.0, has_path)
        assert (stage.mission.recoveries, stage.mission.is_blocked) == (n, False)
    stage.recovers(0.0, has_path)
    assert (stage.mission.recoveries, stage.mission.is_blocked) == (2, True)
    assert stage.mission.reason == (
        "gave up: no progress after 2 recoveries" if has_path else "no way is left: shut"
    )
    assert stage.refined == (0 if has_path else 2)


def test_a_path_lost_after_all_attempts_ends_the_mission_at_once(stage):
    for _ in range(2):
        stage.recovers(0.0, has_path=True)
    assert stage.tick(0.0, has_path=False)[0] == "blocked"


def test_one_tick_without_a_path_does_not_end_a_mission_that_gets_on(stage):
    x = 0.0
    for _ in range(2):
        stage.recovers(x, has_path=False)
        for _ in range(3):  # drives on for more than a metre
            x += 0.5
            stage.tick(x, has_path=True)
    assert stage.tick(x, has_path=False)[0] != "blocked"
    stage.recovers(x, has_path=False)
    assert stage.mission.reason == "no way is left: shut"
