"""How drive, odometry, lidar driver and control loop differ from what the navigator is told.

The defaults are those of a perfect robot. ``Fault`` is for what happens at some moment of a run; these
hold all the time.
"""

import math
from typing import Annotated, NamedTuple

from dynastar.config import Field, self_checking


@self_checking
class Drivetrain(NamedTuple):
    """The drive: the true speed is gain times command, with a dead band, a delay, a lag and slip."""

    gain_v: Annotated[float, Field("true speed over the commanded one", "", 0.1, 3.0)] = 1.0
    gain_omega: Annotated[
        float, Field("true turning rate over the commanded one", "", 0.1, 3.0)
    ] = 1.0
    lag: Annotated[
        float, Field("time constant with which speeds follow commands, first order", "s", 0.0, 2.0)
    ] = 0.0
    deadband_v: Annotated[
        float, Field("speed commands below this do not move the drive", "m/s", 0.0, 1.0)
    ] = 0.0
    deadband_omega: Annotated[
        float, Field("turning commands below this do not move the drive", "rad/s", 0.0, 2.0)
    ] = 0.0
    slip: Annotated[
        float,
        Field(
            "largest share of each speed that slip takes: drawn anew, from 0 to this, for each command",
            "",
            0.0,
            0.9,
        ),
    ] = 0.0
    latency_jitter: Annotated[
        float,
        Field(
            "a command acts up to this much sooner than `latency`, drawn anew each", "s", 0.0, 1.0
        ),
    ] = 0.0


@self_checking
class Odometry(NamedTuple):
    """The reported speeds: gain x speed of the wheels, which slip does not change. Poses are right."""

    gain_v: Annotated[float, Field("reported speed over that of the wheels", "", 0.1, 3.0)] = 1.0
    gain_omega: Annotated[
        float, Field("reported turning rate over that of the wheels", "", 0.1, 3.0)
    ] = 1.0


@self_checking
class Post(NamedTuple):
    """A part of the robot's own body that the lidar sees."""

    angle: Annotated[float, Field("its direction in the lidar's frame", "rad", -math.tau, math.tau)]
    distance: Annotated[float, Field("the range that is read there", "m", 0.0, 10.0)]
    readings: Annotated[int, Field("number of readings that it covers", "", 1, 1000)] = 1


@self_checking
class LidarDriver(NamedTuple):
    """What the lidar's driver makes of a scan."""

    nothing: Annotated[
        float, Field("written where nothing is in range; inf if left out", "m", nan_is_legal=True)
    ] = math.inf
    readings: Annotated[
        tuple[int, int] | None,
        Field("least and largest number of readings, drawn anew for each scan", "", 2, 20000),
    ] = None
    rounding: Annotated[float, Field("step to which ranges are rounded", "m", 0.0, 1.0)] = 0.0
    posts: Annotated[tuple[Post, ...], Field("parts of the robot that the lidar sees")] = ()


@self_checking
class ControlLoop(NamedTuple):
    """When commands are really given."""

    period: Annotated[
        float | None,
        Field("time between two commands; the navigator's `period` if left out", "s", 0.01, 5.0),
    ] = None
    jitter: Annotated[
        float, Field("a period lasts up to this much longer, drawn anew each", "s", 0.0, 5.0)
    ] = 0.0


PERFECT: dict[str, NamedTuple] = {  # by the name of a scenario's field and table
    "drive": Drivetrain(),
    "odometry": Odometry(),
    "lidar": LidarDriver(),
    "loop": ControlLoop(),
}
