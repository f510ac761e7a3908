"""Suite paper: section V's experiment as a family of worlds, seeded and numbered from 0.

20 x 20 cells of 1 m with the map's origin at (1, 1), 20 % of them occupied, from S (1.5, 1.5) to
G (20.5, 20.5). Two unknown blocks, a cell each, stand at one and two thirds of the traditional A*
path; a disc goes to and fro on a straight free lane across the middle.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options, endless
from dynastar.bench.own_maps import own_twenty
from dynastar.errors import DataError, NoPath
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.planning import HeuristicConfig, SearchGrid, plan, segment_clear
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Scenario

DEFAULT_MISSIONS = 500
QUICK_MISSIONS = 16

COMPARABLE = (
    "The worlds are drawn in the manner of the paper's Figs. 6 and 7; the paper prints one run in one of "
    "them. Without noise and latency, as in the paper; `dynastar paper` has its tables."
)

CELLS = 20
OCCUPIED = 0.2
START, GOAL = (1.5, 1.5), (20.5, 20.5)
ROBOT = ROBOTS["paper"]
MOVER_RADIUS, MOVER_SPEED = 0.3, 0.5
LANE_LEAST, LANE_MOST = 6.0, 12.0  # m between the lane's ends
TOLERANCE, TIME_LIMIT = 0.5, 400.0

Mask = npt.NDArray[np.bool_]
Lane = npt.NDArray[np.float64]

missions = endless


def leave_out(mission: Mission, options: Options) -> str:
    """Worlds that the rule leaves out: no way for the footprint, or no lane for the disc."""
    made = world(options.seed, mission.number)
    return made if isinstance(made, str) else ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The world of a mission; DataError for one that the rule leaves out."""
    del repeat
    made = world(options.seed, mission.number)
    if isinstance(made, str):
        raise DataError(f"paper {mission.number} is left out: {made}")
    return made


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives one world and returns its metrics as a row."""
    return driven.run_mission(scenario(mission, options, repeat), options, mission, repeat)


@lru_cache(maxsize=4)
def world(seed: int, number: int, occupied: float = OCCUPIED) -> Scenario | str:
    """The scenario of a number, or why the rule leaves it out.

    ``occupied`` is the fraction of the map's cells; that of the suite unless another is given.
    """
    rng = np.random.default_rng([seed, number])
    free_cells = np.array([c for c in range(CELLS * CELLS) if c not in (0, CELLS * CELLS - 1)])
    flat = np.zeros(CELLS * CELLS, bool)
    flat[rng.choice(free_cells, round(occupied * CELLS * CELLS), replace=False)] = True
    return furnished(f"paper {number}", flat.reshape(CELLS, CELLS))


def own_world() -> Scenario:
    """The same experiment on the project's own map, drawn in the manner of Figs. 6 and 7.

    As in print, the unknown blocks stand on the improved A*'s path.
    """
    made = furnished("own 20 x 20", own_twenty(), "improved")
    assert isinstance(made, Scenario)
    return made


def furnished(name: str, occupied: Mask, planner: str = "weighted") -> Scenario | str:
    """A map (20, 20) with two unknown blocks on a planner's way and the disc across the middle.

    Or why there is no such experiment. "weighted" is the traditional A* here.
    """
    try:
        # Of ways of one length, the heap's: the worlds do not change with the faster kernels.
        path = (
            SearchGrid(occupied)
            .search((0, 0), (CELLS - 1, CELLS - 1), planner, HeuristicConfig(weight=1.0))
            .cells
        )
    except NoPath:
        return "no way on the map"
    blocks = [tuple(int(i) for i in path[round(len(path) * third / 3)]) for third in (1, 2)]
    true = occupied.copy()
    for row, column in blocks:
        true[row, column] = True
    grid = OccupancyGrid.from_occupied(occupied, 1.0, 1.0, 1.0)
    try:
        plan(
            OccupancyGrid.from_occupied(true, 1.0, 1.0, 1.0),
            START,
            GOAL,
            "astar",
            ROBOT.footprint.circumscribed,
        )
    except NoPath:
        return "no way past the unknown blocks"
    lane = free_lane(true)
    if lane is None:
        return "no free lane across the middle"
    length = math.dist(*lane)
    mover = Mover(MOVER_RADIUS, np.array([0.0, length / MOVER_SPEED]), lane, "back_and_forth")
    return Scenario(
        name=name,
        grid=grid,
        robot=ROBOT,
        start=(*START, None),
        goals=(Goal(*GOAL),),
        obstacles=tuple(_square(1.0 + column, 1.0 + row) for row, column in blocks),
        movers=(mover,),
        goal_tolerance=TOLERANCE,
        time_limit=TIME_LIMIT,
    )


def free_lane(occupied: Mask) -> Lane | None:
    """The disc's lane (2, 2): the straight stretch across the middle nearest to the map's centre.

    Tried are lines at right angles to the way from S to G, then along the rows and the columns,
    each through a point of that way up to 3 m from the centre in steps of 0.25 m, nearest first.
    A lane is as long as it is free for the disc, at least 6 m and at most 12 m.
    """
    centre = np.full(2, CELLS / 2)  # (row, column), in cells of 1 m
    steps = sorted(np.arange(-3.0, 3.01, 0.25), key=abs)
    for direction in ((-1.0, 1.0), (0.0, 1.0), (1.0, 0.0)):
        along = np.array(direction) / math.hypot(*direction)
        for step in steps:
            middle = centre + step * math.sqrt(0.5)
            reach = [_reach(occupied, middle, sign * along) for sign in (-1.0, 1.0)]
            if min(reach) > 0.0 and sum(reach) >= LANE_LEAST:
                ends = np.array([middle - reach[0] * along, middle + reach[1] * along])
                return np.asarray(ends[:, ::-1] + 1.0)
    return None


def _reach(occupied: Mask, start: Lane, direction: Lane) -> float:
    """Metres that the disc gets from ``start`` along ``direction``, half the longest lane at most."""
    reach = 0.0
    while reach < LANE_MOST / 2:
        end = start + (reach + 0.25) * direction
        inside = (end >= MOVER_RADIUS).all() and (end <= CELLS - MOVER_RADIUS).all()
        if not inside or not segment_clear(occupied, start, end, MOVER_RADIUS):
            break
        reach += 0.25
    return reach


def _square(x: float, y: float) -> Lane:
    return np.array([(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)])
