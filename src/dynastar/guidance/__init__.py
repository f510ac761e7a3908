"""Guidance: the way to the goal over the local map, as a cost-to-go."""

from dynastar.guidance.cost_to_go import CostToGo
from dynastar.guidance.guidance import Guidance, Guide, PathTarget
from dynastar.guidance.travel_cost import Encounter

__all__ = ["CostToGo", "Encounter", "Guidance", "Guide", "PathTarget"]
