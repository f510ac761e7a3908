"""Laser scans: what a lidar says, and which points that means."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from dynastar.config import shown, summary
from dynastar.errors import InputError
from dynastar.extras import plotter
from dynastar.geometry import Pose2D

if TYPE_CHECKING:  # Matplotlib comes with an extra
    from matplotlib.axes import Axes

LEAST_INCREMENT = 1e-5  # rad
RANGES_UP_TO = 1.001  # times range_max, up to which a reading counts as range_max
ROUNDED_DOWN = 1.0 - 1e-7  # times a limit, which a reading of it may be as a float32
FARTHEST = 1e3  # m from the robot's centre to a mount, and rad of an angle
NUMBERS = "stamp", "angle_min", "angle_increment", "range_min", "range_max"


@dataclass(frozen=True, eq=False)
class LaserScan:
    """One turn of a planar lidar, as sensor_msgs/LaserScan has it, with the pose of its mount.

    ``ranges`` (n,) metres: beam i points at ``angle_min + i * angle_increment`` in the sensor's
    frame. ``readings`` says what they mean. ``range_max`` may be +inf: then the robot's ``Lidar`` says
    how far a beam without a return is free. ``mount`` is the sensor's pose on the robot; ``stamp`` the
    time in seconds of the whole scan. ``frame`` names the lidar where there are several; those without a
    name are told apart by their mounts.
    Raises InputError for what is not a number, and for ranges of another shape.
    """

    stamp: float
    ranges: npt.NDArray[np.float32]
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    mount: Pose2D = Pose2D(0.0, 0.0, 0.0)
    frame: str = ""

    def __post_init__(self) -> None:
        name = "ranges"
        try:
            ranges = np.array(self.ranges, dtype=np.float32)
            for name in NUMBERS:  # kernels would be compiled again for an int
                object.__setattr__(self, name, float(getattr(self, name)))
            name = "mount"
            object.__setattr__(self, name, Pose2D(*map(float, self.mount)))
        except (TypeError, ValueError, OverflowError) as error:
            given = shown(getattr(self, name))
            raise InputError(f"{name} of a scan: got {given} ({error}), expected numbers") from None
        if ranges.ndim != 1:
            raise InputError(f"ranges of a scan: got the shape {ranges.shape}, expected (n,)")
        if not isinstance(self.frame, str):
            raise InputError(f"frame of a scan: got {shown(self.frame)}, expected a name")
        ranges.flags.writeable = False
        object.__setattr__(self, "ranges", ranges)

    def __repr__(self) -> str:
        found = self.readings()
        hits, unknown = found[np.isfinite(found)], np.isnan(found).sum()
        span = math.degrees(abs(self.angle_increment)) * max(len(found) - 1, 0)
        return summary(
            self,
            f"{len(found)} beams over {span:.0f} degrees",
            f"{len(hits)} hits from {hits.min():.2f} m on" if len(hits) else "no hits",
            f"{unknown} without information" if unknown else "",
            f"range {self.range_min:g} to {self.range_max:g} m",
            f"at {self.stamp:g} s",
        )

    def plot(self, ax: "Axes | None" = None, pose: Pose2D = Pose2D(0.0, 0.0, 0.0)) -> "Axes":
        """Draw hits and free beams, in metres, into ``ax`` or new Matplotlib axes, and return them.

        ``pose`` is the robot's in the frame of the axes, as in ``scan.plot(grid.plot(), pose)``.
        Raises MissingPackage without Matplotlib.
        """
        return plotter("plot_scan")(self, ax, pose)

    @property
    def angles(self) -> npt.NDArray[np.float64]:
        """Direction of every beam in the sensor's frame, rad."""
        beams = np.arange(len(self.ranges), dtype=np.float64)
        return np.asarray(self.angle_min + self.angle_increment * beams)

    @property
    def full_circle(self) -> bool:
        """True if the beams go all round, so that the last one is next to the first."""
        step = abs(self.angle_increment)
        return bool(step * len(self.ranges) > math.tau - 0.5 * step)

    def readings(self) -> npt.NDArray[np.float64]:
        """What each beam found (n,): the range (m) of a hit, +inf for no hit, NaN for no information.

        A beam that reads range_max or +inf hit nothing up to range_max. NaN, -inf, 0 and readings below
        range_min or beyond range_max have no information.
        """
        ranges = self.ranges.astype(np.float64)
        low, high = ROUNDED_DOWN * self.range_min, ROUNDED_DOWN * self.range_max
        beyond = (ranges > RANGES_UP_TO * self.range_max) & (ranges < np.inf)
        is_free = (ranges >= high) & ~beyond
        ranges[~((ranges > 0.0) & (ranges >= low) & (ranges < high))] = np.nan
        ranges[is_free] = np.inf
        return ranges

    def fault(self) -> str | None:
        """Describe why this scan is unusable, or None. Its number of beams may differ each time."""
        n = len(self.ranges)
        if n < 2:
            return f"the scan has {n or 'no'} beam{'s' if n == 0 else ''}: expected 2 or more"
        numbers = (self.stamp, self.angle_min, self.angle_increment, *self.mount)
        if not all(map(math.isfinite, numbers)):
            return "the scan's stamp, angles or mount are not finite"
        if max(map(abs, (self.angle_min, *self.mount))) > FARTHEST:
            x, y, theta = self.mount
            return (
                f"the scan begins at {self.angle_min:g} rad from a mount at ({x:g}, {y:g}, {theta:g}): "
                f"expected within 1000 m and rad"
            )
        if self.angle_increment == 0.0 or abs(self.angle_increment) * (n - 1) > math.tau + 1e-3:
            return f"the scan's {n} beams at {self.angle_increment:g} rad do not fit in a circle"
        if abs(self.angle_increment) < LEAST_INCREMENT:
            return f"the scan's increment is {self.angle_increment:g} rad: expected 1e-5 or more"
        if not (0.0 <= self.range_min < self.range_max):
            return f"the scan's ranges run from {self.range_min:g} to {self.range_max:g} m"
        return None


def as_scans(value: Any) -> list[Any]:
    """The scans of one, of a sequence of scans or of None; what is not a scan is one that has a fault."""
    if value is None:
        return []
    if isinstance(value, LaserScan | str | bytes):
        return [value]
    try:
        return list(value)
    except TypeError:
        return [value]
