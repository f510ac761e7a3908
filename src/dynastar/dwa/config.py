"""The dynamic window's settings: the weights of Eq. 9, what is sampled, and how it is scored."""

from typing import Annotated, Literal, NamedTuple

from dynastar.config import Field


class Weights(NamedTuple):
    """alpha, beta, gamma and sigma of Eqs. 8 and 9."""

    heading: Annotated[float, Field("alpha: points at the target", "", 0.0, 100.0)] = 0.3
    dist: Annotated[float, Field("beta: keeps clear of obstacles", "", 0.0, 100.0)] = 0.2
    vel: Annotated[float, Field("gamma: drives fast", "", 0.0, 100.0)] = 0.2
    simi: Annotated[float, Field("sigma: stays on the global path", "", 0.0, 100.0)] = 1.0


class DwaConfig(NamedTuple):
    """Settings of one dynamic window."""

    weights: Weights = Weights()
    horizon: Annotated[float, Field("how far ahead a trajectory is scored", "s", 0.2, 30.0)] = 3.0
    steps: Annotated[int, Field("points of a trajectory over the horizon", "", 2, 1000)] = 30
    reach: Annotated[
        float, Field("a sample is reached in so long at most; 0: in one period", "s", 0.0, 5.0)
    ] = 1.0
    v_samples: Annotated[int, Field("speeds in the window", "", 2, 1000)] = 20
    omega_samples: Annotated[int, Field("turning rates in the window", "", 2, 1000)] = 40
    v_resolution: Annotated[float, Field("step between speeds; 0: by count", "m/s", 0.0, 1.0)] = 0.0
    omega_resolution: Annotated[
        float, Field("step between turning rates; 0: by count", "rad/s", 0.0, 1.0)
    ] = 0.0
    normalisation: Annotated[
        Literal["window", "range", "sum"],
        Field("terms over their range, vel over the window's or v_max; or over their sum"),
    ] = "window"
    dist: Annotated[
        Literal["smallest", "end"], Field("clearance along the trajectory, or at its end (Eq. 8)")
    ] = "smallest"
    clearance_cap: Annotated[float, Field("more clearance is no better", "m", 0.01, 10.0)] = 1.0
    clearance_of_path: Annotated[bool, Field("nor is more than the path ahead has")] = True
    path_cap: Annotated[float, Field("further off the path is no worse", "m", 0.01, 10.0)] = 1.0
    turn_in_place: Annotated[
        float, Field("a target further aside is turned to before driving", "rad", 0.0, 3.15)
    ] = 1.2
