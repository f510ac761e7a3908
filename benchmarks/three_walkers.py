"""The paper's worlds with up to three walkers each: ``python benchmarks/three_walkers.py [N] [SEED]``.

Of N worlds (default 100) of a seed (default 7, which no table uses): how many robots arrive, how many
are touched, how long they take. With one walker so few are that hundreds of worlds do not tell one rule
from another.
"""

import dataclasses
import itertools
import math
import os
import sys
from functools import partial

import numpy as np

from dynastar.bench import paper
from dynastar.bench.missions import row_of
from dynastar.bench.workers import spread
from dynastar.metrics import measure
from dynastar.simulation import Mover, Scenario, run

WALKERS = 3
START_CLEAR = 2.5  # m from the start to a lane's ends


def furnished(seed: int, number: int) -> Scenario | None:
    """A world with one walker more for each free lane found once the lanes before are taken."""
    made = paper.world(seed, number)
    if isinstance(made, str):
        return None
    taken = made.grid.occupied.copy()
    for ring in made.obstacles:
        row, column = made.grid.frame.to_grid(*np.mean(ring, axis=0))
        taken[int(row), int(column)] = True
    movers: list[Mover] = []
    while len(movers) < WALKERS and (lane := paper.free_lane(taken)) is not None:
        length = math.dist(*lane)
        if min(math.dist(end, made.start[:2]) for end in lane) > START_CLEAR:
            times = np.array([0.0, length / paper.MOVER_SPEED])
            movers.append(Mover(paper.MOVER_RADIUS, times, lane, "back_and_forth"))
        for x, y in np.linspace(*lane, 2 * math.ceil(length)):
            row, column = made.grid.frame.to_grid(x, y)
            taken[int(row), int(column)] = True
    return dataclasses.replace(made, movers=tuple(movers))


def drive(number: int, seed: int) -> dict[str, object]:
    """One world's metrics."""
    made = furnished(seed, number)
    assert made is not None
    return {"number": number, **row_of(lambda: measure(run(made))._asdict())}


def main() -> None:
    """Prints what became of the robots."""
    from tqdm import tqdm

    count, seed = (int(word) for word in [*sys.argv[1:], *("100", "7")[len(sys.argv) - 1 :]])
    numbers = (n for n in itertools.count() if furnished(seed, n) is not None)
    chosen = list(itertools.islice(numbers, count))
    driven = spread(partial(drive, seed=seed), chosen, os.cpu_count() or 1)
    rows = list(tqdm(driven, total=count, file=sys.stderr))
    arrived = [row for row in rows if row["outcome"] == "arrived"]
    moving, resting = (
        sum(bool(row.get(f"contacts_{kind}")) for row in rows) for kind in ("moving", "resting")
    )
    print(f"{len(arrived)} of {count} arrived, {moving} touched while moving, {resting} at rest")
    for name, unit in (("time", "s"), ("length", "m"), ("turning_points", "turning points")):
        print(f"{np.mean([row[name] for row in arrived]):.1f} {unit}")
    print("lost:", *(row["number"] for row in rows if row["outcome"] != "arrived"))


if __name__ == "__main__":
    main()
