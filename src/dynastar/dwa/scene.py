"""What a dynamic window is judged against, as the kernels take it."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.perception.hidden import Hidden
from dynastar.perception.prediction import People

Floats = npt.NDArray[np.float64]


class DistanceField(NamedTuple):
    """Metres from each cell's centre to the nearest marked cell's; low corner (x0, y0), resolution."""

    distance: npt.NDArray[np.float32]
    x0: float
    y0: float
    resolution: float


class CostToGo(NamedTuple):
    """The cost-to-go (m) over the local map, see ``cost_to_go``."""

    value: Floats
    filled: Floats
    bearing: Floats
    x0: float
    y0: float
    resolution: float


class Scene(NamedTuple):
    """What a window is judged against.

    ``closed`` are distances to what is not observed free, ``obstacles`` to what is occupied.
    ``margin`` (m) is kept from both; ``ahead`` (s) is when a command given now acts.
    """

    closed: DistanceField
    obstacles: DistanceField
    cost_to_go: CostToGo
    people: People
    hidden: Hidden
    margin: float
    ahead: float
    last_v: float
    last_omega: float
