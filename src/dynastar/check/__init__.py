"""Checks before driving: what a robot's numbers, its map and a recording say, in sentences."""

from dynastar.check.checking import Check, check_robot
from dynastar.check.finding import Finding
from dynastar.check.passages import Passage

__all__ = ["Check", "Finding", "Passage", "check_robot"]
