"""One HTML file that replays episodes: the page of ``static`` with their data in it."""

import base64
import gzip
import html
import json
import math
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.dwa.dwa import REFUSALS, TERMS
from dynastar.episode import Episode, Trace
from dynastar.errors import InputError
from dynastar.io.files import jsonable, written_aside

SCRIPTS = ("scene.js", "charts.js", "report.js")
MOST = 2  # episodes side by side


def write_report(episodes: Sequence[Episode], path: str | Path) -> None:
    """Writes ``report_html``. Raises InputError if it cannot."""
    text = report_html(episodes)
    with written_aside(path) as aside:
        aside.write_text(text, encoding="utf-8")


def report_html(episodes: Sequence[Episode]) -> str:
    """A page, without need of a network, that replays one episode, or two on one clock."""
    if not 1 <= len(episodes) <= MOST:
        raise InputError(f"a report shows one or two episodes, not {len(episodes)}")
    data = json.dumps(jsonable([_data(one) for one in episodes]), allow_nan=False)
    packed = base64.b64encode(gzip.compress(data.encode("utf-8"), mtime=0)).decode("ascii")
    title = " and ".join(name_of(one) for one in episodes)
    page = _static("page.html")
    for mark, text in (
        ("{{title}}", html.escape(title)),
        ("{{style}}", _static("page.css")),
        ("{{script}}", "\n".join(map(_static, SCRIPTS))),
        ("{{data}}", packed),
    ):
        page = page.replace(mark, text)
    return page


def framed(episode: Episode) -> str:
    """``report_html`` of one episode in an iframe, for a notebook's cell."""
    page = html.escape(report_html([episode]), quote=True)
    style = "width: 100%; height: 50rem; border: 0"
    return (
        f'<iframe srcdoc="{page}" style="{style}" title="{html.escape(name_of(episode))}"></iframe>'
    )


def name_of(episode: Episode) -> str:
    """The scenario's name, or the robot's."""
    return str(episode.scenario.get("name") or episode.robot)


def _static(name: str) -> str:
    return files("dynastar.page").joinpath("static", name).read_text(encoding="utf-8")


def _data(episode: Episode) -> dict[str, Any]:
    """An episode as the page takes it: plain values, and arrays as typed base64."""
    trajectory, grid = episode.trajectory, episode.grid
    return {
        "name": name_of(episode),
        "robot": episode.robot,
        "preset": episode.scenario.get("preset", ""),
        "outcome": episode.outcome,
        "reason": episode.reason,
        "grid": {
            "rows": grid.rows,
            "columns": grid.columns,
            "frame": [*grid.frame],
            "values": _packed(grid.values, np.int8),
            "keepout": None if grid.keepout is None else _packed(grid.keepout, np.uint8),
        },
        "radius": episode.radius,
        "footprint": episode.footprint,
        "goals": [
            [x, y, None if math.isnan(heading) else heading] for x, y, heading in episode.goals
        ],
        "tolerance": episode.goal_tolerance,
        "obstacles": list(episode.obstacles),
        "times": _packed(trajectory.times, np.float32),
        "poses": _packed(trajectory.poses, np.float32),
        "twists": _packed(trajectory.twists, np.float32),
        "commands": _packed(episode.commands, np.float32),
        "clearance": _packed(episode.clearance, np.float32),
        "states": _words(episode.states),
        "limits": _words(episode.limits),
        "movers": _packed(episode.movers, np.float32),
        "moverRadii": episode.mover_radii,
        "plans": [
            {
                "time": plan.stamp,
                "reason": plan.reason,
                "points": _packed(plan.points, np.float32),
                "explored": _packed(_runs(plan.explored), np.int32),
            }
            for plan in episode.plans
        ],
        "exploredFrame": list(episode.explored_frame),
        "events": [[event.stamp, event.kind, event.detail] for event in episode.events],
        "termNames": TERMS,
        "refusals": {str(code): words for code, words in REFUSALS.items()},
        "trace": None if episode.trace is None else _trace(episode.trace),
    }


def _trace(trace: Trace) -> dict[str, Any]:
    return {
        "candidates": _packed(trace.candidates, np.float32),
        "refused": _packed(trace.refused, np.uint8),
        "candidateRows": _packed(trace.candidate_rows, np.uint16),
        "terms": _packed(trace.terms, np.float32),
        "chosen": _packed(trace.chosen, np.float32),
        "tracks": _packed(trace.tracks, np.float32),
        "trackRows": _packed(trace.track_rows, np.uint16),
        "reasons": _words(trace.reasons),
        "seen": _packed(trace.seen, np.int32),
        "seenFrame": list(trace.seen_frame),
    }


def _packed(values: npt.NDArray[Any], kind: Any) -> dict[str, str]:
    """An array, little-endian, as the page decodes it; floats keep their first 17 bits or so."""
    array = np.ascontiguousarray(values, dtype=kind)
    if array.dtype == np.float32:
        array = _rounded(array)
    data = base64.b64encode(array.astype(array.dtype.newbyteorder("<")).tobytes())
    return {"kind": array.dtype.name, "data": data.decode("ascii")}


def _rounded(array: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Values whose last bits are 0, which compress well: to about one part in 30000."""
    bits = array.view(np.uint32) & np.uint32(0xFFFFFF00)
    return np.where(np.isfinite(array), bits.view(np.float32), array)


def _words(words: npt.NDArray[np.str_]) -> dict[str, Any]:
    """Names as a table and the row of each."""
    table, rows = np.unique(np.asarray(words, np.str_), return_inverse=True)
    return {"table": table.tolist(), "rows": _packed(rows, np.uint16)}


def _runs(cells: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Cells (m, 2) of row and column as runs (k, 3) along rows: row, first column, number."""
    if not len(cells):
        return np.empty((0, 3), np.int32)
    ordered = cells[np.lexsort((cells[:, 1], cells[:, 0]))]
    begins = np.flatnonzero(
        np.r_[True, (np.diff(ordered[:, 0]) != 0) | (np.diff(ordered[:, 1]) != 1)]
    )
    counts = np.diff(np.r_[begins, len(ordered)])
    return np.column_stack([ordered[begins], counts]).astype(np.int32)
