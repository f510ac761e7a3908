"""Episodes as one compressed file: NumPy arrays and a JSON header in a zip (what ``.npz`` is).

``header`` is UTF-8 JSON with the format's version and all that is no array; every other member is
an array of ``Episode`` by name, lists of them flattened with the rows of each counted.
"""

import json
import warnings
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.config import shown
from dynastar.episode import Episode, EventRecord, PlanRecord, Trace
from dynastar.errors import DynastarWarning, EpisodeError, MapError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io.archive import Arrays, arrays_before_cut, arrays_in
from dynastar.io.files import read_bytes
from dynastar.path import Trajectory
from dynastar.paths import local_path
from dynastar.writing import written_aside

VERSION = 1
MAX_EPISODE_BYTES = 2**29  # unpacked
MAX_HEADER_BYTES = 2**24

# Shape of every array: n ticks, m movers, k corners, -1 for any number.
_SHAPES: dict[str, tuple[Any, ...]] = {
    "values": (-1, -1),
    "footprint": (-1, 2),
    "goals": (-1, 3),
    "times": ("n",),
    "poses": ("n", 3),
    "twists": ("n", 2),
    "commands": ("n", 2),
    "clearance": ("n",),
    "command_ms": ("n",),
    "states": ("n",),
    "limits": ("n",),
    "movers": ("n", "m", 2),
    "mover_radii": ("m",),
    "obstacle_points": (-1, 2),
    "obstacle_rows": (-1,),
    "plan_points": (-1, 2),
    "plan_rows": (-1,),
    "explored": (-1, 2),
    "explored_rows": (-1,),
}
# Of a Trace, that an episode may have.
_TRACE: dict[str, tuple[Any, ...]] = {
    "candidates": ("k", 3),
    "refused": ("k",),
    "candidate_rows": ("t",),
    "terms": ("t", -1),  # as many as Eq. 9 had when it was written
    "chosen": ("t", 3),
    "tracks": ("j", 5),
    "track_rows": ("t",),
    "reasons": ("t",),
    "seen": (-1, 4),
}
_TEXTS = ("states", "limits", "reasons")
_COUNTS = (
    "values",
    "explored",
    *(name for name in {**_SHAPES, **_TRACE} if name.endswith("_rows")),
)
_OPTIONAL = ("limits", *_TRACE)  # was not recorded before
_MASKS = ("keepout", "speed_limit")
_KNOWN = {*_SHAPES, *_MASKS, *_TRACE}
# Order in the file: the drive is before what is larger, so that a file that was cut off still has it.
# What an episode may lack is before what it has, so that it is known what was lost.
_EXPLORED = ("explored", "explored_rows")
_DRIVE = [name for name in _SHAPES if name not in (*_EXPLORED, "limits")]
_ORDER = ("header", *_MASKS, "limits", *_DRIVE, *_EXPLORED, *_TRACE)


def save_episode(episode: Episode, path: str | Path) -> None:
    """Writes an episode; by custom the suffix is ``.npz``. Raises EpisodeError if it cannot."""
    path = local_path(path, EpisodeError)
    header = {
        "format": "dynastar episode",
        "version": VERSION,
        "frame": list(episode.grid.frame),
        "robot": episode.robot,
        "radius": episode.radius,
        "goal_tolerance": episode.goal_tolerance,
        "plans": [[plan.stamp, plan.reason] for plan in episode.plans],
        "events": [list(event) for event in episode.events],
        "outcome": episode.outcome,
        "reason": episode.reason,
        "contact": episode.contact,
        "explored_frame": list(episode.explored_frame),
        "config": episode.config,
        "scenario": episode.scenario,
        "seen_frame": None if episode.trace is None else list(episode.trace.seen_frame),
    }
    try:
        # NaN and infinity stay what they are: this JSON is read by load_episode alone.
        packed = json.dumps(header, default=_plain).encode("utf-8")
    except (TypeError, ValueError) as error:
        raise EpisodeError(f"{path}: the episode cannot be written: {error}") from None
    arrays = _arrays(episode) | {"header": np.frombuffer(packed, dtype=np.uint8)}
    arrays = {name: arrays[name] for name in _ORDER if name in arrays}
    with written_aside(path, EpisodeError) as aside, aside.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)


def load_episode(path: str | Path) -> Episode:
    """The episode in a file; EpisodeError if it is damaged, none, or of another version.

    One that was cut off is read with a warning if the drive is before the cut.
    """
    path = local_path(path, EpisodeError)
    data = read_bytes(path, MAX_EPISODE_BYTES, EpisodeError)
    try:
        arrays, lost = _read(data)
        header = _header(arrays.pop("header"))
        _check(arrays)
        found = _episode(header, arrays)
    except (EpisodeError, MapError) as error:
        raise EpisodeError(f"{path}: {error}") from None
    except KeyError as error:
        raise EpisodeError(f"{path}: the episode lacks {error}") from None
    except Exception as error:  # zipfile, zlib and numpy raise many kinds for damage
        raise EpisodeError(f"{path}: damaged, or not an episode ({error!s:.100})") from None
    if lost:
        drive = f"its drive of {len(found.commands)} ticks is read, but not {lost}"
        warnings.warn(f"{path} was cut off or is damaged: {drive}", DynastarWarning, stacklevel=2)
    return found


def _read(data: bytes) -> tuple[Arrays, str]:
    """The arrays of a file with its header, and what was lost where the file was cut off, or ""."""
    try:
        return arrays_in(data, {*_KNOWN, "header"}, MAX_EPISODE_BYTES), ""
    except zipfile.BadZipFile:
        arrays = arrays_before_cut(data, MAX_EPISODE_BYTES)
        if not arrays:
            raise
    return _without_rest(arrays)


def _without_rest(arrays: Arrays) -> tuple[Arrays, str]:
    """The arrays of a file that was cut off with empty ones for the missing, and what is missing.

    Raises EpisodeError if a part of the drive is missing.
    """
    header = _header(arrays["header"])
    ends = [name for name in _DRIVE if name not in arrays]
    if ends:
        raise EpisodeError(f"cut off or damaged: it ends at '{ends[0]}', before the drive is whole")
    lost = []
    if not arrays.keys() >= set(_EXPLORED):
        lost.append("the cells that its plans looked at")
        arrays["explored"] = np.empty((0, 2), np.int32)
        arrays["explored_rows"] = np.zeros_like(arrays["plan_rows"])
    if not arrays.keys() >= _TRACE.keys() and header["seen_frame"] is not None:
        lost.append("what the navigator considered at each tick")
        arrays = {name: array for name, array in arrays.items() if name not in _TRACE}
    return arrays, " and ".join(lost) or "its index"


def _arrays(episode: Episode) -> Arrays:
    arrays: Arrays = {
        "values": episode.grid.values,
        "footprint": episode.footprint,
        "goals": episode.goals,
        "times": episode.trajectory.times,
        "poses": episode.trajectory.poses,
        "twists": episode.trajectory.twists,
        "commands": episode.commands,
        "clearance": episode.clearance,
        "command_ms": episode.command_ms,
        "states": np.asarray(episode.states, dtype=np.str_),
        "movers": episode.movers,
        "mover_radii": episode.mover_radii,
    }
    if len(episode.limits):
        arrays["limits"] = np.asarray(episode.limits, dtype=np.str_)
    if episode.trace is not None:
        arrays |= {name: getattr(episode.trace, name) for name in _TRACE}
    for mask in _MASKS:
        if getattr(episode.grid, mask) is not None:
            arrays[mask] = getattr(episode.grid, mask)
    plans = episode.plans
    for points, rows, parts, dtype in (
        ("obstacle_points", "obstacle_rows", episode.obstacles, np.float64),
        ("plan_points", "plan_rows", tuple(plan.points for plan in plans), np.float64),
        ("explored", "explored_rows", tuple(plan.explored for plan in plans), np.int32),
    ):
        arrays[points] = np.concatenate([np.empty((0, 2), dtype), *parts], dtype=dtype)
        arrays[rows] = np.array([len(part) for part in parts], dtype=np.int64)
    return arrays


def _header(packed: npt.NDArray[Any]) -> dict[str, Any]:
    if packed.nbytes > MAX_HEADER_BYTES:
        raise EpisodeError(f"its header has more than {MAX_HEADER_BYTES} bytes")
    header = json.loads(packed.tobytes().decode("utf-8"))
    if not isinstance(header, dict) or header.get("format") != "dynastar episode":
        raise EpisodeError("this is not an episode of dynastar")
    if header.get("version") != VERSION:
        raise EpisodeError(
            f"the episode has version {shown(header.get('version'))}, this dynastar reads {VERSION}"
        )
    return header


def _check(arrays: Arrays) -> None:
    """Raises EpisodeError unless every array has its shape, and KeyError if one is missing."""
    sizes: dict[str, int] = {}
    for name, shape in (_SHAPES | _TRACE).items():
        if name in _OPTIONAL and name not in arrays:
            continue
        found = arrays[name].shape
        fits = len(found) == len(shape)
        for wanted, size in zip(shape, found, strict=False):
            if isinstance(wanted, str):
                wanted = sizes.setdefault(wanted, size)
            fits &= wanted in (-1, size)
        if not fits:
            raise EpisodeError(f"'{name}' has shape {found}: expected {shape} with {sizes}")
        text = arrays[name].dtype.kind == "U"
        if text != (name in _TEXTS) or arrays[name].dtype.kind not in "Uuifb":
            raise EpisodeError(f"'{name}' is of {arrays[name].dtype}: expected numbers or names")
        if name in _COUNTS and arrays[name].dtype.kind not in "ui":
            raise EpisodeError(f"'{name}' is of {arrays[name].dtype}: expected whole numbers")
    times = arrays["times"].astype(np.float64)
    if not (np.isfinite(times).all() and (np.diff(times) >= 0.0).all()):
        raise EpisodeError("'times' are not finite or go back: expected seconds that rise")


def _episode(header: dict[str, Any], arrays: Arrays) -> Episode:
    for array in arrays.values():
        array.flags.writeable = False
    grid = OccupancyGrid(
        arrays["values"],
        GridFrame(*map(float, header["frame"])),
        *(arrays.get(mask) for mask in _MASKS),
    )
    points = _split(arrays, "plan_points", "plan_rows")
    explored = _split(arrays, "explored", "explored_rows")
    plans = zip(header["plans"], points, explored, strict=True)
    resolution, x, y, yaw = map(float, header["explored_frame"])
    return Episode(
        grid=grid,
        robot=str(header["robot"]),
        radius=float(header["radius"]),
        footprint=arrays["footprint"],
        goals=arrays["goals"],
        goal_tolerance=float(header["goal_tolerance"]),
        trajectory=Trajectory(arrays["times"], arrays["poses"], arrays["twists"]),
        commands=arrays["commands"],
        clearance=arrays["clearance"],
        command_ms=arrays["command_ms"],
        states=arrays["states"],
        movers=arrays["movers"],
        mover_radii=arrays["mover_radii"],
        obstacles=_split(arrays, "obstacle_points", "obstacle_rows"),
        plans=tuple(PlanRecord(float(t), str(why), p, cells) for (t, why), p, cells in plans),
        events=tuple(EventRecord(float(t), str(kind), str(d)) for t, kind, d in header["events"]),
        outcome=str(header["outcome"]),
        reason=str(header["reason"]),
        contact=str(header["contact"]),
        explored_frame=(resolution, x, y, yaw),
        limits=arrays.get("limits", np.empty(0, np.str_)),
        config=dict(header["config"]),
        scenario=dict(header["scenario"]),
        trace=_trace(header, arrays),
    )


def _trace(header: dict[str, Any], arrays: Arrays) -> Trace | None:
    """The Trace of an episode that has one."""
    if "candidates" not in arrays:
        return None
    for rows, parts in (("candidate_rows", "candidates"), ("track_rows", "tracks")):
        _split(arrays, parts, rows)  # that they add up
    resolution, x, y, yaw = map(float, header["seen_frame"])
    named = {name: arrays[name] for name in _TRACE}
    return Trace(**named, seen_frame=(resolution, x, y, yaw))


def _split(arrays: Arrays, points: str, rows: str) -> tuple[npt.NDArray[Any], ...]:
    counts = arrays[rows].astype(np.int64)
    if (counts < 0).any() or counts.sum() != len(arrays[points]):
        raise EpisodeError(f"'{rows}' does not add up to the rows of '{points}'")
    if len(counts) == 0:
        return ()
    return tuple(np.split(arrays[points], np.cumsum(counts)[:-1]))


def _plain(value: Any) -> Any:
    """Convert NumPy's numbers and arrays for JSON."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a header cannot hold a {type(value).__name__}")
