"""A collision monitor with zones round the robot, rebuilt from Nav2's documentation [Nav2Monitor].

Where enough points of the scan lie within the stop zone the command is zero; within the slow-down
zone it is a fraction of what is asked for. The zones, the fraction and the number of points are those
of the parameter file that comes with Nav2's package, in the robot's frame.
"""

import numpy as np

from dynastar.footprint import Footprint
from dynastar.geometry import Twist
from dynastar.navigator import Guarded
from dynastar.scan import LaserScan

STOP_ZONE = Footprint.polygon([(0.3, 0.3), (0.3, -0.3), (0.0, -0.3), (0.0, 0.3)])
SLOW_ZONE = Footprint.polygon([(0.4, 0.4), (0.4, -0.4), (-0.4, -0.4), (-0.4, 0.4)])
SLOWDOWN = 0.3  # of the speeds asked for
FEWEST = 4  # points within a zone


class Monitor:
    """Stops or slows commands down while there is something in a zone."""

    def filter(self, scan: LaserScan | None, wanted: Twist) -> Guarded:
        """The command that the zones leave; zero without a scan."""
        if scan is None:
            return Guarded(Twist(0.0, 0.0), True, "no scan")
        ranges, (x, y, theta) = scan.readings(), scan.mount
        hits = np.isfinite(ranges)
        angles = theta + scan.angles[hits]
        points = np.column_stack(
            [x + ranges[hits] * np.cos(angles), y + ranges[hits] * np.sin(angles)]
        )
        if np.count_nonzero(STOP_ZONE.covers(points)) >= FEWEST:
            return Guarded(Twist(0.0, 0.0), True, "stop zone")
        if np.count_nonzero(SLOW_ZONE.covers(points)) >= FEWEST:
            return Guarded(
                Twist(SLOWDOWN * wanted.v, SLOWDOWN * wanted.omega), True, "slow-down zone"
            )
        return Guarded(wanted, False)
