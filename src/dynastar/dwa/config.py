"""The dynamic window's settings: the weights of Eq. 9, what is sampled, and how it is scored."""

from typing import Annotated, NamedTuple

from dynastar.config import Field, self_checking


@self_checking
class Weights(NamedTuple):
    """alpha, beta, gamma and sigma of Eq. 9, rho of the risk and nu of the nearness."""

    heading: Annotated[float, Field("alpha: progress towards the goal", "", 0.0, 100.0)] = 1.0
    dist: Annotated[float, Field("beta: keeps clear of obstacles", "", 0.0, 100.0)] = 0.1
    vel: Annotated[float, Field("gamma: drives fast", "", 0.0, 100.0)] = 0.1
    simi: Annotated[float, Field("sigma: stays on the global path", "", 0.0, 100.0)] = 0.0
    risk: Annotated[float, Field("rho: avoids contact with moving obstacles", "", 0.0, 100.0)] = (
        14.0
    )
    nearness: Annotated[float, Field("nu: keeps out of personal_space", "", 0.0, 100.0)] = 1.0


@self_checking
class DwaConfig(NamedTuple):
    """Settings of one dynamic window."""

    weights: Weights = Weights()
    arc_time: Annotated[
        float, Field("shortest time for which a sample is held", "s", 0.1, 10.0)
    ] = 0.5
    horizon: Annotated[float, Field("how far ahead manoeuvres are scored", "s", 0.2, 30.0)] = 4.0
    reach: Annotated[
        float,
        Field("time within which a sampled velocity is reached; 0: one period", "s", 0.0, 5.0),
    ] = 1.0
    v_samples: Annotated[int, Field("speeds in the window", "", 2, 1000)] = 5
    omega_samples: Annotated[int, Field("turning rates in the window", "", 2, 1000)] = 11
    comfort: Annotated[
        float, Field("clearance beyond which the dist term is constant", "m", 0.01, 10.0)
    ] = 0.25
    personal_space: Annotated[
        float, Field("gap to moving obstacles below which nearness counts", "m", 0.01, 10.0)
    ] = 0.45
    hysteresis: Annotated[
        float, Field("score by which a new manoeuvre must exceed the last one", "", 0.0, 10.0)
    ] = 0.02
