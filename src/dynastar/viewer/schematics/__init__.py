"""The paper's drawings of an idea: Fig. 1, Fig. 4, Fig. 5, and Fig. 8, which it only names."""

from dynastar.viewer.schematics.braking import draw_braking
from dynastar.viewer.schematics.drive import draw_drive
from dynastar.viewer.schematics.numbering import draw_numbering
from dynastar.viewer.schematics.system import draw_system

__all__ = ["draw_braking", "draw_drive", "draw_numbering", "draw_system"]
