"""What a controller tells about itself."""

from dataclasses import dataclass

from dynastar.errors import PlanningError
from dynastar.grid import GridFrame
from dynastar.planning import Plan


@dataclass(frozen=True)
class Status:
    """Status of a controller as the simulation reads it after each command.

    ``state`` and ``reason`` say what it does; ``plan_id`` rises with every new ``plan``, whose cells
    belong to ``planning_frame``; ``error`` is why no plan could be made where that ended the mission;
    ``limited_by`` is what limited the speed in this tick, "" for nothing.
    """

    state: str = "idle"
    reason: str = "no goal"
    recoveries: int = 0
    plan: Plan | None = None
    plan_id: int = 0
    plan_reason: str = ""
    planning_frame: GridFrame = GridFrame(1.0)
    error: PlanningError | None = None
    limited_by: str = ""
