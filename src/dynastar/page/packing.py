"""Values as the page's scripts take them: arrays as typed base64, and the static files themselves."""

import base64
import html
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.grid import OccupancyGrid

EXACT_FROM = 8.0  # m, from which on values are rounded to multiples of
FINEST = 2.0**-12  # m


def static(name: str) -> str:
    """The text of a file of the page."""
    return files("dynastar.page").joinpath("static", name).read_text(encoding="utf-8")


def filled(page: str, title: str, scripts: Sequence[str]) -> str:
    """A page with its title, its style and its scripts inside."""
    parts = (
        ("{{title}}", html.escape(title)),
        ("{{style}}", static("page.css")),
        ("{{script}}", "\n".join(map(static, scripts))),
    )
    text = static(page)
    for mark, part in parts:
        text = text.replace(mark, part)
    return text


def grid_data(grid: OccupancyGrid) -> dict[str, Any]:
    """A map as the page takes it."""
    return {
        "rows": grid.rows,
        "columns": grid.columns,
        "frame": [*grid.frame],
        "values": packed(grid.values, np.int8),
        "keepout": None if grid.keepout is None else packed(grid.keepout, np.uint8),
    }


def packed(values: npt.NDArray[Any], kind: Any) -> dict[str, str]:
    """An array, little-endian, as the page decodes it; floats keep their first 17 bits or so."""
    array = np.ascontiguousarray(values, dtype=kind)
    if array.dtype == np.float32:
        array = _rounded(array)
    data = base64.b64encode(array.astype(array.dtype.newbyteorder("<")).tobytes())
    return {"kind": array.dtype.name, "data": data.decode("ascii")}


def _rounded(array: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Values whose last bits are 0, which compress well: to about one part in 30000, or to 0.2 mm.

    A place far from the map's origin is as exact as one near it.
    """
    bits = array.view(np.uint32) & np.uint32(0xFFFFFF00)
    found = np.where(np.isfinite(array), bits.view(np.float32), array)
    far = np.isfinite(array) & (np.abs(array) >= EXACT_FROM)
    found[far] = np.round(array[far].astype(np.float64) / FINEST) * FINEST
    return found


def words(words: npt.NDArray[np.str_]) -> dict[str, Any]:
    """Names as a table and the row of each."""
    table, rows = np.unique(np.asarray(words, np.str_), return_inverse=True)
    return {"table": table.tolist(), "rows": packed(rows, np.uint16)}


def runs(cells: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Cells (m, 2) of row and column as runs (k, 3) along rows: row, first column, number."""
    if not len(cells):
        return np.empty((0, 3), np.int32)
    ordered = cells[np.lexsort((cells[:, 1], cells[:, 0]))]
    begins = np.flatnonzero(
        np.r_[True, (np.diff(ordered[:, 0]) != 0) | (np.diff(ordered[:, 1]) != 1)]
    )
    counts = np.diff(np.r_[begins, len(ordered)])
    return np.column_stack([ordered[begins], counts]).astype(np.int32)
