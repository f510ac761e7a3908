"""The record of a run: data only, enough to draw it, measure it and run it again."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar import notebook
from dynastar.config import counted, shown, summary
from dynastar.extras import plotter
from dynastar.grid import OccupancyGrid
from dynastar.path import Trajectory, ends_of
from dynastar.table import as_dataframe, write_csv

if TYPE_CHECKING:  # both come with extras
    from matplotlib.axes import Axes
    from pandas import DataFrame

Floats = npt.NDArray[np.float64]


class PlanRecord(NamedTuple):
    """A global plan when it was made: ``points`` (n, 2) m, why it was made, explored cells (m, 2)."""

    stamp: float
    reason: str
    points: Floats
    explored: npt.NDArray[np.int32]

    def __repr__(self) -> str:
        made = f"made at {self.stamp:.2f} s ({shown(self.reason)})"
        points = counted(len(self.points), "point")
        return summary(
            self, made, points, ends_of(self.points), f"{len(self.explored)} cells explored"
        )


class EventRecord(NamedTuple):
    """Something that happened: ``kind`` is 'recovery', 'state', 'contact', ...; ``detail`` in words."""

    stamp: float
    kind: str
    detail: str

    def __repr__(self) -> str:
        return summary(self, f"{shown(self.kind)} at {self.stamp:.2f} s", shown(self.detail))


@dataclass(frozen=True, eq=False)
class Trace:
    """What the navigator considered and chose at each of n ticks.

    ``candidates`` (k, 3) are v (m/s), omega (rad/s) and score of the window's samples, ``refused`` (k,)
    codes of ``dwa.REFUSALS`` (0 not refused), ``candidate_rows`` (n,) how many belong to each tick.
    ``terms`` (n, t) are those of Eq. 9 of the chosen sample and ``chosen`` (n, 3) its v, omega and the
    seconds it is held, NaN where none was chosen. ``tracks`` (j, 5) are x, y, vx, vy and radius of tracked
    obstacles, ``track_rows`` (n,) how many each tick has. ``reasons`` (n,) says why in words. ``seen``
    (m, 4) are tick, row, column and whether the planning map took that cell for blocked from then on, by
    what was sensed; ``seen_frame`` is (resolution, x, y, yaw) of these cells.
    """

    candidates: npt.NDArray[np.float32]
    refused: npt.NDArray[np.uint8]
    candidate_rows: npt.NDArray[np.int64]
    terms: npt.NDArray[np.float32]
    chosen: npt.NDArray[np.float32]
    tracks: npt.NDArray[np.float32]
    track_rows: npt.NDArray[np.int64]
    reasons: npt.NDArray[np.str_]
    seen: npt.NDArray[np.int32]
    seen_frame: tuple[float, float, float, float]

    def __repr__(self) -> str:
        candidates, refused = len(self.candidates), np.count_nonzero(self.refused)
        ticks = counted(len(self.reasons), "tick")
        return summary(self, ticks, f"{candidates} candidates, {refused} of them refused")


@dataclass(frozen=True, eq=False)
class Episode:
    """One mission: what was asked, what the world was, what was driven, and how it ended.

    ``radius`` is the circumscribed one and ``footprint`` (k, 2) the polygon, (0, 2) for a disc.
    Per tick (n rows): ``trajectory`` is the truth, ``commands`` (n, 2) what was asked of the drive,
    ``clearance`` (n,) the true gap between footprint and anything in metres, ``command_ms`` (n,) the
    time a ``command`` took, ``movers`` (n, m, 2) where they truly were, ``mover_radii`` (m,),
    ``states`` (n,) the navigator's state by name, ``limits`` (n,) what limited the speed as far as the
    navigator says so, else "", and empty where that was not recorded. ``obstacles`` lists the polygons
    (k, 2) that the map did not have. ``explored_frame`` is (resolution, x, y, yaw) of the plans'
    explored cells. ``trace`` has what the navigator considered, if that was recorded.
    """

    grid: OccupancyGrid
    robot: str
    radius: float
    footprint: Floats
    goals: Floats
    goal_tolerance: float
    trajectory: Trajectory
    commands: Floats
    clearance: Floats
    command_ms: Floats
    states: npt.NDArray[np.str_]
    movers: Floats
    mover_radii: Floats
    obstacles: tuple[Floats, ...]
    plans: tuple[PlanRecord, ...]
    events: tuple[EventRecord, ...]
    outcome: str
    reason: str
    contact: str
    explored_frame: tuple[float, float, float, float]
    limits: npt.NDArray[np.str_] = field(default_factory=lambda: np.empty(0, np.str_))
    config: dict[str, Any] = field(default_factory=dict)
    scenario: dict[str, Any] = field(default_factory=dict)
    trace: Trace | None = None

    def __repr__(self) -> str:
        times = self.trajectory.times
        gaps = self.clearance[np.isfinite(self.clearance)]
        return summary(
            self,
            f"{self.outcome} ({shown(self.reason)})",
            f"contact ({self.contact})" if self.contact else "",
            f"{times[-1] - times[0]:.1f} s and {self.trajectory.length:.2f} m driven by {shown(self.robot)}"
            if len(times)
            else "nothing driven",
            counted(len(times), "tick"),
            f"clearance at least {gaps.min():.2f} m" if len(gaps) else "",
            counted(len(self.goals), "goal"),
            counted(len(self.plans), "plan"),
            counted(len(self.obstacles), "unmapped obstacle"),
            counted(len(self.mover_radii), "mover"),
            "with its trace" if self.trace is not None else "",
        )

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the mission on its map, in metres, into ``ax`` or new Matplotlib axes, and return them.

        New axes have a bar with the colours of the speeds. Raises MissingPackage without Matplotlib.
        """
        return plotter("plot_episode")(self, ax)

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """One array (n,) per column of the ticks, by name; the names end in their units.

        Poses and speeds are the true ones, commands what was asked of the drive.
        """
        driven = self.trajectory
        columns: dict[str, npt.NDArray[Any]] = {"time_s": driven.times}
        columns |= zip(("x_m", "y_m", "heading_rad"), driven.poses.T, strict=True)
        columns |= zip(("v_mps", "omega_radps"), driven.twists.T, strict=True)
        columns |= zip(("command_v_mps", "command_omega_radps"), self.commands.T, strict=True)
        columns |= {"clearance_m": self.clearance, "command_ms": self.command_ms}
        columns["state"] = self.states
        return columns | ({"limited_by": self.limits} if len(self.limits) else {})

    def to_dataframe(self) -> "DataFrame":
        """A pandas DataFrame of the ticks, see ``columns``. Raises MissingPackage without pandas."""
        return as_dataframe(self.columns())

    def to_csv(self, path: str | Path) -> None:
        """Write the ticks, see ``columns``, to a CSV file with a line of names."""
        write_csv(self.columns(), path)

    def _repr_html_(self) -> str:
        """The replay as a notebook shows it: the page of ``dynastar view`` in a frame."""
        return notebook.episode_html(self)
