"""How short the paper's worlds can be driven at all: ``python benchmarks/length_floor.py [N]``.

For the first N worlds that `dynastar bench paper` runs (default 500), four mean lengths in metres, to
the goal's tolerance and without the walker:

- the default preset's first plan, which does not know the two unknown blocks;
- its plan on the true map, the blocks known beforehand;
- the way of a point that follows the plans exactly: it turns on the spot and at once, and plans anew
  the moment it sees a block, whole, within the lidar's range. No robot that learns of the blocks by
  driving does much better; the robot of Table II has to swing, to brake and to let the walker pass;
- the same with blocks of half a cell's side, to tell what their size is worth.
"""

import itertools
import sys

import numpy as np
import numpy.typing as npt

from dynastar.bench import paper
from dynastar.bench.missions import Options
from dynastar.navigator import Navigator
from dynastar.navigator.planners import Planners
from dynastar.path import Path
from dynastar.perception.planning_map import Patch
from dynastar.planning import segment_clear
from dynastar.simulation import Scenario

STEP = 0.2  # m between two looks
SEEN = 2  # points of a block that have to be seen

Block = tuple[float, float, float]  # low corner (x, y) and side, m


def planners_of(scenario: Scenario) -> Planners:
    """The default preset's planners for the paper's robot."""
    return Navigator(scenario.grid, scenario.robot).planners


def add(planners: Planners, block: Block) -> None:
    """Marks a block as seen."""
    x, y, side = block
    planning_map = planners.planning_map
    rows, columns = np.indices(planning_map.prior.shape)
    frame = planning_map.frame
    at_x = frame.x + (columns + 0.5) * frame.resolution
    at_y = frame.y + (rows + 0.5) * frame.resolution
    mask = (at_x > x) & (at_x < x + side) & (at_y > y) & (at_y < y + side)
    planning_map.blocked |= mask
    planners.mark(Patch(0, 0, planning_map.blocked))


def visible(scenario: Scenario, solid: npt.NDArray[np.bool_], at: Path, block: Block) -> bool:
    """Whether enough of a block's faces is in sight from ``at`` within the lidar's range."""
    x, y, side = block
    across = np.linspace(0.02, 0.98, 9) * side
    out = 0.01
    faces = [
        *((x + a, y - out) for a in across), *((x + a, y + side + out) for a in across),
        *((x - out, y + a) for a in across), *((x + side + out, y + a) for a in across),
    ]  # fmt: skip
    fine = 4  # cells per metre, so that half blocks fit
    here = ((at[1] - 1.0) * fine, (at[0] - 1.0) * fine)
    seen = 0
    for px, py in faces:
        if np.hypot(px - at[0], py - at[1]) < scenario.robot.lidar.range_max:
            seen += segment_clear(solid, here, ((py - 1.0) * fine, (px - 1.0) * fine), 0.0)
    return seen >= SEEN


def blocks_of(scenario: Scenario, side: float) -> list[Block]:
    """The unknown blocks, shrunk about their centres."""
    found = []
    for corners in scenario.obstacles:
        x, y = corners.mean(axis=0)
        found.append((float(x) - side / 2, float(y) - side / 2, side))
    return found


def planned(planners: Planners) -> Path:
    """The plan from start to goal."""
    return planners.plan(paper.START, paper.GOAL).path


def followed(scenario: Scenario, blocks: list[Block]) -> float:
    """Metres that a point drives until it is within the goal's tolerance."""
    planners = planners_of(scenario)
    solid = np.kron(scenario.grid.occupied, np.ones((4, 4), bool))
    for x, y, side in blocks:
        row, column, n = round((y - 1) * 4), round((x - 1) * 4), round(side * 4)
        solid[row : row + n, column : column + n] = True
    hidden, path, driven, length = list(blocks), planned(planners), 0.0, 0.0
    here = paper.START
    while np.hypot(here[0] - paper.GOAL[0], here[1] - paper.GOAL[1]) > paper.TOLERANCE:
        found = [block for block in hidden if visible(scenario, solid, here, block)]
        for block in found:
            hidden.remove(block)
            add(planners, block)
        if found:
            path, driven = planners.plan(here, paper.GOAL).path, 0.0
        step = min(STEP, path.length - driven)
        driven, length = driven + step, length + step
        here = path.at(driven)
    return length


def main() -> None:
    """Prints the table."""
    from tqdm import tqdm

    count = int(sys.argv[1]) if len(sys.argv) > 1 else paper.DEFAULT_MISSIONS
    options = Options()
    numbers = (n for n in itertools.count() if not isinstance(paper.world(options.seed, n), str))
    rows = []
    for number in tqdm(itertools.islice(numbers, count), total=count, file=sys.stderr):
        scenario = paper.world(options.seed, number)
        assert isinstance(scenario, Scenario)
        whole, half = blocks_of(scenario, 1.0), blocks_of(scenario, 0.5)
        known = planners_of(scenario)
        first = planned(known).length - paper.TOLERANCE
        for block in whole:
            add(known, block)
        true = planned(known).length - paper.TOLERANCE
        rows.append((first, true, followed(scenario, whole), followed(scenario, half)))
    names = "first plan", "plan on the true map", "point, whole blocks", "point, half blocks"
    for name, mean in zip(names, np.mean(rows, axis=0), strict=True):
        print(f"{name:22}{mean:6.2f} m")


if __name__ == "__main__":
    main()
