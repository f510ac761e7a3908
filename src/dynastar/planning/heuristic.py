"""The improved heuristic (section III.A, Eqs. 2-3) and the terms of it that a planner uses."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Annotated, Literal, NamedTuple

from dynastar.config import Field, self_checking
from dynastar.planning.heap_kernel import Terms
from dynastar.planning.labels import STRAIGHT

AROUND = 1  # cells of the map, the half width of what is "around n" where Q is a ratio


@self_checking
class HeuristicConfig(NamedTuple):
    """The terms of h_A(n) = e^(P/Q) (h(n) + h(p) - k cos(beta)), each with its readings.

    The defaults are the readings this project decided on; the literal ones are there to compare.
    """

    estimate: Annotated[
        Literal["octile", "euclidean"],
        Field("h: distance on an 8-connected grid, or in a straight line"),
    ] = "octile"
    exponential: Annotated[bool, Field("weight the estimate by e^(P/Q)")] = True
    q: Annotated[
        Literal["rectangle", "line", "ratio"],
        Field(
            "Q: cells of the rectangle start - goal, or of a line between them; "
            "or P / Q as the obstacles in the 3 x 3 cells around n over all obstacles"
        ),
    ] = "rectangle"
    parent: Annotated[bool, Field("add the parent's estimate h(p)")] = True
    k: Annotated[float, Field("weight of cos(beta), 0 for none", "cells", 0.0, 1e6)] = 1.0
    beta: Annotated[
        Literal["progress", "interior"],
        Field("beta: between start -> n and n -> goal, or the angle at n from start to goal"),
    ] = "progress"
    weight: Annotated[float, Field("w of the weighted A*", "", 0.0, 100)] = 2.0


# What each planner leaves of Eq. 3: f(n) = g(n) + weight e^(P/Q) (h(n) + h(p) - k cos(beta)).
PLANNERS: dict[str, Callable[[HeuristicConfig], HeuristicConfig]] = {
    "dijkstra": lambda c: c._replace(exponential=False, parent=False, k=0.0, weight=0.0),
    "astar": lambda c: c._replace(exponential=False, parent=False, k=0.0, weight=1.0),
    "weighted": lambda c: c._replace(exponential=False, parent=False, k=0.0),
    "improved": lambda c: c._replace(weight=1.0),
}


@lru_cache
def terms_of(planner: str, config: HeuristicConfig) -> HeuristicConfig:
    """What a planner leaves of ``config``; checking settings takes longer than a short search."""
    return PLANNERS[planner](config)


def kernel_terms(
    config: HeuristicConfig,
    start: tuple[int, int],
    goal: tuple[int, int],
    occupied: int,
    cell: int = 1,
) -> Terms:
    """Terms for the search kernel; ``occupied`` is the number of occupied cells.

    Cells are those of the grid that is searched; a cell of the map is ``cell`` of them wide.
    """
    rows, columns = abs(start[0] - goal[0]) + 1, abs(start[1] - goal[1]) + 1
    line = cell * max(rows, columns)
    q = {"rectangle": rows * columns, "line": line, "ratio": max(occupied, 1)}
    return Terms(
        weight=float(config.weight),
        euclidean=config.estimate == "euclidean",
        adaptive=config.exponential or config.parent or config.k > 0.0,
        exponential=config.exponential,
        q=float(q[config.q]),
        around=cell * AROUND + cell // 2 if config.q == "ratio" else 0,
        parent=config.parent,
        # The angle at n is pi less the angle of progress, so its cosine has the other sign.
        k=math.copysign(config.k * cell * STRAIGHT, 1.0 if config.beta == "progress" else -1.0),
    )
