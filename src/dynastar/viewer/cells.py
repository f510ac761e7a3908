"""Cells of a small grid as one shape, which stays sharp and small however it is printed."""

from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from shapely import union_all
from shapely.geometry import Polygon, box
from shapely.geometry.polygon import orient

from dynastar.grid import GridFrame


def outline_of(cells: npt.ArrayLike, frame: GridFrame) -> Outline:
    """The outline, in metres, of ``cells`` (n, 2) of (row, column) in ``frame``, holes left out."""
    boxes = [box(c, r, c + 1, r + 1) for r, c in np.asarray(cells).reshape(-1, 2).tolist()]
    whole = union_all(boxes)
    parts = [orient(p) for p in getattr(whole, "geoms", [whole]) if isinstance(p, Polygon)]
    rings = [ring for p in parts if not p.is_empty for ring in (p.exterior, *p.interiors)]
    if not rings:
        return Outline(np.empty((0, 2)))
    corners = [np.asarray(ring.simplify(0.0).coords)[:, ::-1] for ring in rings]
    return Outline.make_compound_path(
        *(Outline(frame.points_to_world(ring), closed=True) for ring in corners)
    )


def show_cells(axes: Axes, cells: npt.ArrayLike, frame: GridFrame, **style: Any) -> PathPatch:
    """Draws ``cells`` (n, 2) of (row, column) as one shape in a patch's ``style``; gives the patch."""
    patch = PathPatch(outline_of(cells, frame), **{"linewidth": 0.0, **style})
    axes.add_patch(patch)
    return patch
