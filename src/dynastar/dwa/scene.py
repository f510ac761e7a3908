"""What the samples of a dynamic window are evaluated against, as the kernels take it."""

from typing import NamedTuple

from dynastar.dwa.clearance import Closed
from dynastar.field import Field
from dynastar.guidance.cost_to_go import CostToGo
from dynastar.perception.hidden import Hidden
from dynastar.perception.prediction import Prediction


class Manoeuvre(NamedTuple):
    """Speeds to hold (m/s, rad/s), for how long (s), and the tail that follows."""

    v: float
    omega: float
    hold: float
    tail: int


TAILS = FOLLOW, STOP, BACK = 0, 1, 2  # follow the cost-to-go, brake to rest, reverse
AT_REST = Manoeuvre(0.0, 0.0, 0.0, STOP)


class Surroundings(NamedTuple):
    """What a stop has to keep clear of: all that admissibility takes.

    ``closed`` is what is not observed free. The footprint keeps ``margin_to_closed`` (m) from it, which
    is less than the margin where the robot stands nearer than that. ``latency`` (s) is when a command
    given now acts.
    """

    closed: Closed
    moving: Prediction
    hidden: Hidden
    margin_to_closed: float
    latency: float


class Scene(NamedTuple):
    """The scene against which a window is evaluated: what stops keep clear of ``around``, and more.

    ``distance_to_obstacle`` is to what is occupied, from whose cells the footprint keeps ``margin`` (m).
    ``last`` is the rest of the manoeuvre chosen last, ``v_cap`` (m/s) the speed limit, ``path_weight``
    the least weight of keeping to the path.
    """

    around: Surroundings
    distance_to_obstacle: Field
    distance_to_path: Field
    cost_to_go: CostToGo
    margin: float
    last: Manoeuvre
    v_cap: float
    path_weight: float
