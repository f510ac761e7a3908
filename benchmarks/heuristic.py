"""What the improved heuristic costs: ``python benchmarks/heuristic.py``.

The heap's kernel, once with f = g + h and once with all terms of Eq. 2, towards a goal that is walled in:
both expand every cell that can be reached, so the work is the same but for the heuristic.
"""

import math
import time

import numpy as np
from maps import random_cells, rooms

from dynastar.errors import NoPath
from dynastar.planning import HeuristicConfig, SearchGrid

N, REPEATS = 512, 5


def main() -> None:
    """Prints a line for each map."""
    print(f"{'map':12}{'expanded':>10}{'plain':>9}{'improved':>10}{'ratio':>8}   ns an expansion")
    for name, occupied in (
        ("random 10%", random_cells(N, 0.1, 0)),
        ("random 30%", random_cells(N, 0.3, 0)),
        ("rooms 33", rooms(N, 33, 0)),
    ):
        goal = N // 2, N // 2
        occupied[goal[0] - 2 : goal[0] + 3, goal[1] - 2 : goal[1] + 3] = True
        occupied[goal] = False
        start = tuple(int(i) for i in np.argwhere(~occupied)[len(occupied) // 3])
        grid = SearchGrid(occupied)
        least, counts = {}, {}
        for algorithm, config in (
            ("weighted", HeuristicConfig(weight=1.0)),
            ("improved", HeuristicConfig()),
        ):
            least[algorithm] = math.inf
            for _ in range(REPEATS):
                began = time.perf_counter()
                try:
                    grid.search(start, goal, algorithm, config)
                except NoPath:
                    least[algorithm] = min(least[algorithm], time.perf_counter() - began)
            counts[algorithm] = len(grid.expanded_cells())
        assert counts["weighted"] == counts["improved"]
        plain, improved = (1e9 * least[k] / counts[k] for k in ("weighted", "improved"))
        print(
            f"{name:12}{counts['improved']:10}{plain:9.1f}{improved:10.1f}{improved / plain:8.2f}"
        )


if __name__ == "__main__":
    main()
