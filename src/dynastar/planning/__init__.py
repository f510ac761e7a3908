"""Global planning (section III): searches, the improved heuristic, smoothing."""

from dynastar.planning.any_angle import straighten
from dynastar.planning.external import Planner, plan_by
from dynastar.planning.heuristic import PLANNERS, HeuristicConfig
from dynastar.planning.plan_type import Plan, PlannerConfig
from dynastar.planning.planner import GridPlanner, plan
from dynastar.planning.search import ALGORITHMS, SearchGrid, SearchResult
from dynastar.planning.segments import segment_clear
from dynastar.planning.smoothing import smooth
from dynastar.planning.warming import warm_up

__all__ = [
    "ALGORITHMS",
    "PLANNERS",
    "GridPlanner",
    "HeuristicConfig",
    "Plan",
    "Planner",
    "PlannerConfig",
    "SearchGrid",
    "SearchResult",
    "plan",
    "plan_by",
    "segment_clear",
    "smooth",
    "straighten",
    "warm_up",
]
