"""One HTML file that replays episodes: the page of ``static`` with their data in it."""

import base64
import gzip
import html
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.dwa.dwa import REFUSALS, TERMS
from dynastar.episode import Episode, Trace
from dynastar.errors import EpisodeError, InputError
from dynastar.io.files import jsonable
from dynastar.page.packing import filled, grid_data, packed, runs, words
from dynastar.writing import written_aside

SCRIPTS = ("scene.js", "charts.js", "legend.js", "panel.js", "report.js")
MOST = 2  # episodes side by side


def write_report(episodes: Sequence[Episode], path: str | Path) -> None:
    """Writes ``report_html``. Raises InputError if it cannot."""
    text = report_html(episodes)
    with written_aside(path) as aside:
        aside.write_text(text, encoding="utf-8", errors="backslashreplace")


def report_html(episodes: Sequence[Episode]) -> str:
    """A page, without need of a network, that replays one episode, or two on one clock."""
    if not 1 <= len(episodes) <= MOST:
        raise InputError(f"a report shows one or two episodes, not {len(episodes)}")
    data = json.dumps(jsonable([_data(one) for one in episodes]), allow_nan=False)
    squeezed = base64.b64encode(gzip.compress(data.encode("utf-8"), mtime=0)).decode("ascii")
    title = " and ".join(name_of(one) for one in episodes)
    return filled("page.html", title, SCRIPTS).replace("{{data}}", squeezed)


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


def _data(episode: Episode) -> dict[str, Any]:
    """An episode as the page takes it: plain values, and arrays as typed base64."""
    trajectory = episode.trajectory
    return {
        "name": name_of(episode),
        "robot": episode.robot,
        "preset": episode.scenario.get("preset", ""),
        "outcome": episode.outcome,
        "reason": episode.reason,
        "grid": grid_data(episode.grid),
        "radius": episode.radius,
        "footprint": episode.footprint,
        "goals": [
            [x, y, None if math.isnan(heading) else heading] for x, y, heading in episode.goals
        ],
        "tolerance": episode.goal_tolerance,
        "obstacles": list(episode.obstacles),
        "times": packed(trajectory.times, np.float32),
        "poses": packed(trajectory.poses, np.float32),
        "twists": packed(trajectory.twists, np.float32),
        "commands": packed(episode.commands, np.float32),
        "clearance": packed(episode.clearance, np.float32),
        "states": words(episode.states),
        "limits": words(episode.limits),
        "movers": packed(episode.movers, np.float32),
        "moverRadii": episode.mover_radii,
        "plans": [
            {
                "time": plan.stamp,
                "reason": plan.reason,
                "points": packed(plan.points, np.float32),
                "explored": packed(runs(plan.explored), np.int32),
            }
            for plan in episode.plans
        ],
        "exploredFrame": list(episode.explored_frame),
        "events": [[event.stamp, event.kind, event.detail] for event in episode.events],
        "termNames": TERMS if episode.trace is None else _names(episode.trace),
        "refusals": {str(code): words for code, words in REFUSALS.items()},
        "trace": None if episode.trace is None else _trace(episode.trace),
    }


def _names(trace: Trace) -> tuple[str, ...]:
    """Names of the terms that Eq. 9 had when the episode was recorded."""
    columns = trace.terms.shape[1]
    if columns > len(TERMS):
        raise EpisodeError(
            f"the episode has {columns} terms of Eq. 9, this dynastar knows {len(TERMS)}"
        )
    return TERMS[:columns]


def _trace(trace: Trace) -> dict[str, Any]:
    return {
        "candidates": packed(trace.candidates, np.float32),
        "refused": packed(trace.refused, np.uint8),
        "candidateRows": packed(trace.candidate_rows, np.int32),
        "terms": packed(trace.terms, np.float32),
        "chosen": packed(trace.chosen, np.float32),
        "tracks": packed(trace.tracks, np.float32),
        "trackRows": packed(trace.track_rows, np.int32),
        "reasons": words(trace.reasons),
        "seen": packed(trace.seen, np.int32),
        "seenFrame": list(trace.seen_frame),
    }
