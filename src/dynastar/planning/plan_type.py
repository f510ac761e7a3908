"""The settings of a planner, and its result."""

from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

from dynastar.config import Field, counted, self_checking, shown, summary
from dynastar.errors import ConfigError
from dynastar.extras import plotter
from dynastar.path import Path, ends_of
from dynastar.planning.heuristic import HeuristicConfig
from dynastar.planning.search import Cells

if TYPE_CHECKING:  # Matplotlib comes with an extra
    from matplotlib.axes import Axes


MOST_RADIUS = 100.0  # m


def as_radius(radius: float) -> float:
    """A planning radius (m) as a float; ConfigError for one that is not valid."""
    if isinstance(radius, Real) and 0.0 <= radius <= MOST_RADIUS:
        return float(radius)
    raise ConfigError(f"a planning radius is {shown(radius)} m: expected 0 to {MOST_RADIUS:g} m")


@self_checking
class PlannerConfig(NamedTuple):
    """Settings of the search and the smoothing of a path."""

    planner: Annotated[str, Field("dijkstra, astar, jump, auto, weighted or improved")] = "improved"
    heuristic: HeuristicConfig = HeuristicConfig()
    smoothing: Annotated[
        Literal["taut", "any-angle", "none"],
        Field("pull the path taut, or also shorten it at any angle, or leave it"),
    ] = "taut"
    exact: Annotated[
        bool, Field("also search exactly, and take that path if it is clearly shorter")
    ] = False
    rounding: Annotated[
        float, Field("distance from a corner at which its rounding begins", "m", 0.0, 10.0)
    ] = 0.5


@dataclass(frozen=True, eq=False)
class Plan:
    """The result of a planner.

    ``path`` is smoothed, ``grid_path`` the way over the cells' centres; both lie in the map frame,
    in metres, and run exactly from the start to the goal, or to the place near the goal that a
    tolerance allows. ``cells`` (n, 2) are the way's cells and ``cost`` their length in cells.
    ``expanded`` counts the cells that were expanded, ``explored`` (m, 2) lists them or is None;
    ``time_ms`` is for search and smoothing. ``path`` keeps ``radius`` (m) free from ``clear_from``
    metres on; up to there it leads a start out of the inflation, or out of a keep-out zone.
    """

    planner: str
    path: Path
    grid_path: Path
    cells: Cells
    cost: float
    expanded: int
    explored: Cells | None
    time_ms: float
    radius: float
    clear_from: float

    def __repr__(self) -> str:
        return summary(
            self,
            f"{self.path.length:.2f} m by {self.planner}",
            counted(self.path.turns, "turning point"),
            ends_of(self.path.points),
            f"for a disc of radius {self.radius:.2f} m",
            f"{self.expanded} cells expanded in {self.time_ms:.1f} ms",
        )

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw both paths, in metres, into ``ax`` or new Matplotlib axes, and return them.

        ``plan.plot(grid.plot())`` draws them on the map. Raises MissingPackage without Matplotlib.
        """
        return plotter("plot_plan")(self, ax)
