"""What a dynamic window is judged against, as the kernels take it."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.clearance import DistanceField
from dynastar.perception.hidden import Hidden
from dynastar.perception.prediction import People

Floats = npt.NDArray[np.float64]


class CostToGo(NamedTuple):
    """The cost-to-go (m) over the local map, and where it falls, see ``cost_to_go``."""

    value: Floats
    filled: Floats
    slope: Floats
    x0: float
    y0: float
    resolution: float


class Manoeuvre(NamedTuple):
    """Speeds to ask for (m/s, rad/s), for how long (s), and the tail that comes then."""

    v: float
    omega: float
    hold: float
    tail: int


FOLLOW, STOP, BACK = range(3)
AT_REST = Manoeuvre(0.0, 0.0, 0.0, STOP)


class Scene(NamedTuple):
    """The scene against which a window is evaluated.

    ``closed`` are distances to what is not observed free, ``obstacles`` to what is occupied.
    ``margin`` (m) is kept from both, ``kept`` from the former where the robot stands nearer than
    that. ``ahead`` (s) is when a command given now acts, ``last`` what is left of the manoeuvre that
    was chosen last, ``v_cap`` (m/s) the speed limit. ``path`` are distances to the path ahead, and
    ``sigma`` the least weight of keeping to it.
    """

    closed: DistanceField
    obstacles: DistanceField
    cost_to_go: CostToGo
    people: People
    hidden: Hidden
    margin: float
    kept: float
    ahead: float
    last: Manoeuvre
    v_cap: float
    path: DistanceField
    sigma: float
