"""Compares a controller of one's own with the navigator, in the same missions."""

from collections.abc import Sequence

from dynastar import LaserScan, MovingObstacle, Navigator, RobotState, Twist, load_scenario, run
from dynastar.metrics import measure

Scans = LaserScan | Sequence[LaserScan] | None
Movers = Sequence[MovingObstacle] | None


class Careful(Navigator):
    """The navigator at two thirds of its speed: anything with these methods is a controller."""

    def command(self, state: RobotState, scan: Scans, movers: Movers = None) -> Twist:
        """Slows down and turns less in proportion, so that the path stays the same."""
        v, omega = super().command(state, scan, movers)
        return Twist(v / 1.5, omega / 1.5)


for feature in ("speed_limit", "movers"):
    scenario = load_scenario(feature)
    for controller in (Navigator, Careful):
        result = measure(run(scenario, navigator=controller))
        print(
            f"{feature:12} {controller.__name__:10} {result.outcome} after {result.time:.1f} s, "
            f"at least {result.min_clearance:.2f} m from anything"
        )
