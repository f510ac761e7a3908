"""What the improved heuristic costs: ``python benchmarks/heuristic.py``.

The heap's kernel, once with f = g + h and once with the terms of Eq. 2, towards a goal that is walled in:
every cell that can be reached is expanded, so the work is the same but for the heuristic. "At the same
order" all terms but h(p) are computed and weigh nothing (Q without end, k next to 0), so that cells are
entered as they are without; h(p) is one estimate an expansion. "As it is" the terms count: cells are
expanded in another order, and more of them are entered again.
"""

import math
import time

import numpy as np
from maps import random_cells, rooms

from dynastar.errors import NoPath
from dynastar.planning import HeuristicConfig, SearchGrid, search

N, REPEATS = 512, 7
ARMS = {
    "plain": ("weighted", HeuristicConfig(weight=1.0), False),
    "same order": ("improved", HeuristicConfig(parent=False, k=1e-12), True),
    "as it is": ("improved", HeuristicConfig(), False),
}


def main() -> None:
    """Prints a line for each map."""
    kernel_terms = search.kernel_terms
    print(
        f"{'map':12}{'expanded':>10}" + "".join(f"{arm:>12}" for arm in ARMS) + "   ns an expansion"
    )
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
        least, counts = dict.fromkeys(ARMS, math.inf), set()
        for _ in range(REPEATS):
            for arm, (algorithm, config, weightless) in ARMS.items():
                search.kernel_terms = lambda *a, less=weightless: (
                    kernel_terms(*a)._replace(q=1e18) if less else kernel_terms(*a)
                )
                began = time.perf_counter()
                try:
                    grid.search(start, goal, algorithm, config)
                except NoPath:
                    least[arm] = min(least[arm], time.perf_counter() - began)
                counts.add(len(grid.expanded_cells()))
        (expanded,) = counts  # the same for all
        each = [1e9 * least[arm] / expanded for arm in ARMS]
        ratios = ", ".join(f"{ns / each[0]:.2f}" for ns in each[1:])
        print(f"{name:12}{expanded:10}" + "".join(f"{ns:12.1f}" for ns in each) + f"   {ratios}")


if __name__ == "__main__":
    main()
