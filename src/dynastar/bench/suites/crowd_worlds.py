"""Recorded pedestrians as a world: where the robot enters, when it starts, and who walks there.

The recordings begin tracks where the camera's view does, and many in the middle of it. So that nobody
appears next to the robot out of nothing, each pedestrian walks in from off the map: before its first
key it comes at its first velocity, straight, and for 20 s at most. Where an occupied cell is in the
way, the direction it comes from is turned by as little as is needed, up to 60 degrees; where that does
not help, it walks in as far as it can.
"""

import math

import numpy as np
import numpy.typing as npt

from dynastar.clearance import distance_field
from dynastar.errors import DataError, PlanningError
from dynastar.grid import OccupancyGrid
from dynastar.io.pedestrians import Recording
from dynastar.planning import plan
from dynastar.robot import Robot
from dynastar.simulation import Mover
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]
Point = tuple[float, float]

RADIUS = 0.25  # m, of a pedestrian
WALK_IN = 20.0  # s at most
TURNS = np.radians([0.0, *(s * a for a in range(5, 61, 5) for s in (1, -1))])  # tried in turn
FIRST_STEPS = 2  # samples over which the first velocity is taken
BIN = 0.5  # m, of the raster of where pedestrians walk
WALKED_BY = 3  # pedestrians, from which on a bin counts
ROOM = 0.25  # m that an entry leaves beside the footprint
END = 60.0  # s before the end of a recording, its last start
PATIENCE, STEP = 10.0, 0.4  # s that a start is put off at most, and by which steps
CLEAR_FOR, CLEAR = 1.0, 1.0  # s, and m from the start to any pedestrian's disc
DIRECTIONS = {"E": 0, "NE": 1, "N": 2, "NW": 3, "W": 4, "SW": 5, "S": 6, "SE": 7}


def entries(recording: Recording, grid: OccupancyGrid, robot: Robot) -> dict[str, Point]:
    """Where the robot enters and leaves, by compass direction.

    Of the places where three pedestrians or more walk and the robot has room, it is the one that lies
    furthest in the direction; a metre off the middle counts half a metre less. Raises DataError.
    """
    places = _walked(recording)
    field = distance_field(grid.blocked(), grid.resolution)
    need = robot.footprint.circumscribed + ROOM + grid.resolution
    roomy = [
        place
        for place in places
        if grid.contains(*place) and field[grid.world_to_cell(*place)] > need
    ]
    if not roomy:
        raise DataError(f"the recording '{recording.name}' has no place where the robot has room")
    points = np.array(roomy)
    offset = points - np.median(points, axis=0)
    found = {}
    for name, eighth in DIRECTIONS.items():
        angle = eighth * math.pi / 4.0
        ahead = offset @ (math.cos(angle), math.sin(angle))
        aside = np.abs(offset @ (-math.sin(angle), math.cos(angle)))
        x, y = points[int(np.argmax(np.round(ahead - 0.5 * aside, 6)))]
        found[name] = (float(x), float(y))
    return found


def start_times(recording: Recording, count: int) -> list[float]:
    """``count`` times of the recording (s), spread evenly up to 60 s before its end."""
    begin, end = recording.span
    return [float(t) for t in np.round(np.linspace(begin, max(begin, end - END), count), 1)]


def clear_start(recording: Recording, start: Point, nominal: float) -> float | None:
    """The first time from ``nominal`` on at which nobody is near the start for a second; else None.

    Near is a disc within 1 m of the start. Times are tried every 0.4 s, for 10 s.
    """
    everybody = Movers(pedestrians(recording, 0.0, recording.span[1]))
    for k in range(round(PATIENCE / STEP) + 1):
        begin = round(nominal + k * STEP, 1)
        gaps = [
            np.hypot(*(everybody.at(time) - start).T) - RADIUS
            for time in np.arange(begin, begin + CLEAR_FOR + 1e-6, 0.1)
        ]
        if not (np.array(gaps) < CLEAR).any():  # NaN, for who is not there, is not near
            return begin
    return None


def pedestrians(recording: Recording, begin: float, end: float) -> tuple[Mover, ...]:
    """Everybody who is there between two times of the recording; ``begin`` is the movers' time 0."""
    movers = (Mover(RADIUS, keys[:, 0] - begin, keys[:, 1:], "vanish") for keys in recording.tracks)
    return tuple(m for m in movers if m.times[-1] > 0.0 and m.times[0] < end - begin)


def way_exists(grid: OccupancyGrid, robot: Robot, start: Point, goal: Point) -> bool:
    """Whether the robot's disc can go from start to goal."""
    try:
        plan(grid, start, goal, "auto", robot.footprint.circumscribed)
    except PlanningError:
        return False
    return True


def with_walk_in(recording: Recording, grid: OccupancyGrid) -> Recording:
    """The recording with a key in front of each track: where the pedestrian walks in from."""
    field = distance_field(grid.occupied, grid.resolution)
    tracks = []
    for keys in recording.tracks:
        later = keys[min(FIRST_STEPS, len(keys) - 1)]
        velocity = (later[1:] - keys[0, 1:]) / (later[0] - keys[0, 0])
        seconds, way = _walk_in(grid, field, keys[0, 1:], velocity)
        if seconds > 0.05:
            keys = np.vstack([[keys[0, 0] - seconds, *(keys[0, 1:] - seconds * way)], keys])
        tracks.append(keys)
    return recording._replace(tracks=tuple(tracks))


def _walk_in(
    grid: OccupancyGrid, field: npt.NDArray[np.float32], first: Floats, velocity: Floats
) -> tuple[float, Floats]:
    """Time (s) for which a pedestrian walks in, and its velocity (2,)."""
    times = np.arange(0.1, WALK_IN + 0.05, 0.1)
    best, best_way = 0.0, velocity
    for angle in TURNS:
        cos, sin = math.cos(angle), math.sin(angle)
        way = np.array(
            [cos * velocity[0] - sin * velocity[1], sin * velocity[0] + cos * velocity[1]]
        )
        cells = np.floor(grid.frame.points_to_grid(first - times[:, np.newaxis] * way)).astype(int)
        on_map = ((cells >= 0) & (cells < field.shape)).all(axis=1)
        stopped = np.zeros(len(times), bool)
        stopped[on_map] = field[tuple(cells[on_map].T)] < RADIUS
        ends = np.flatnonzero(stopped | ~on_map)
        if len(ends) == 0 or not stopped[ends[0]]:
            return float(times[ends[0]] if len(ends) else times[-1]), way
        if times[ends[0]] - 0.1 > best:
            best, best_way = float(times[ends[0]] - 0.1), way
    return best, best_way


def _walked(recording: Recording) -> Floats:
    """Centres (n, 2) of the bins in which three pedestrians or more walk."""
    bins = [
        np.unique(np.floor(keys[:, 1:] / BIN).astype(np.int64), axis=0) for keys in recording.tracks
    ]
    cells, counts = np.unique(np.vstack(bins), axis=0, return_counts=True)
    return np.asarray((cells[counts >= WALKED_BY] + 0.5) * BIN, dtype=np.float64)
