"""Contact, length and score of a saved episode, worked out from the file alone.

Nothing here comes from dynastar: the file is read with NumPy and JSON, shapes are shapely's, and the
true world is handed in as polygons and discs where the map in the file is not the truth.
"""

import json
import math
import tarfile
from itertools import pairwise
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
import shapely
from shapely import affinity

OCCUPIED_FROM = 65  # of 100, as map_server's 0.65
BETWEEN = 5  # poses looked at between two ticks
JUMP = 0.5  # m; a mover that goes further in one tick was put somewhere else
AT_REST = 0.02  # m/s and rad/s


class Saved(NamedTuple):
    """What a file holds of an episode."""

    header: dict
    arrays: dict


class Found(NamedTuple):
    """What was worked out: the smallest gaps (m), contact ("", "moving", "resting"), length (m)."""

    static_gap: float
    mover_gap: float
    contact: str
    length: float
    at_goal: bool


def read(path):
    with np.load(path, allow_pickle=False) as members:
        arrays = {name: members[name] for name in members.files}
    return Saved(json.loads(arrays.pop("header").tobytes()), arrays)


def found(saved, discs=(), margin=0.0, map_is_true=True):
    """Looks at a saved episode.

    ``discs`` (x, y, radius) stand in the true world beside the episode's polygons. A gap of at most
    ``margin`` metres is a contact. ``map_is_true`` says whether the map's cells stand there.
    """
    arrays = saved.arrays
    times, poses, twists = arrays["times"], arrays["poses"], arrays["twists"]
    solid = _cells(saved) if map_is_true else []
    rings = np.split(arrays["obstacle_points"], np.cumsum(arrays["obstacle_rows"])[:-1])
    solid += [shapely.Polygon(ring) for ring in rings if len(ring)]
    solid += [shapely.Point(x, y).buffer(r, quad_segs=64) for x, y, r in discs]
    solid.append(_border(saved))
    tree = shapely.STRtree(solid)
    static_gap = mover_gap = math.inf
    for tick in range(len(times)):
        for part in range(1 if tick == 0 else BETWEEN):
            share = 1.0 if tick == 0 else (part + 1) / BETWEEN
            before = max(tick - 1, 0)
            pose = poses[before] + share * _difference(poses[before], poses[tick])
            shape, radius = _robot(saved, pose)
            near = tree.query_nearest(shape, return_distance=True)[1]
            static_gap = min(static_gap, float(near[0]) - radius)
            for mover, size in enumerate(arrays["mover_radii"]):
                a, b = arrays["movers"][before, mover], arrays["movers"][tick, mover]
                at = b if math.dist(a, b) > JUMP else a + share * (b - a)
                if np.isfinite(at).all():
                    gap = shape.distance(shapely.Point(at)) - radius - float(size)
                    mover_gap = min(mover_gap, gap)
    contact = ""
    if min(static_gap, mover_gap) <= margin:
        resting = (np.abs(twists[-1]) < AT_REST).all()
        contact = "resting" if resting else "moving"
    steps = [math.dist(a[:2], b[:2]) for a, b in pairwise(poses)]
    goal = arrays["goals"][-1]
    away = math.dist(poses[-1, :2], goal[:2])
    at_goal = not contact and away <= saved.header["goal_tolerance"] + 1e-3
    return Found(static_gap, mover_gap, contact, math.fsum(steps), at_goal)


def _difference(a, b):
    step = np.array(b) - a
    step[2] = math.remainder(step[2], math.tau)
    return step


def _robot(saved, pose):
    """The robot's shape at a pose, and the radius round it: a polygon and 0, or a point and more."""
    corners = saved.arrays["footprint"]
    if len(corners) == 0:
        return shapely.Point(pose[0], pose[1]), saved.header["radius"]
    turned = affinity.rotate(shapely.Polygon(corners), pose[2], origin=(0, 0), use_radians=True)
    return affinity.translate(turned, pose[0], pose[1]), 0.0


def _to_world(saved, shape):
    """A shape given in metres along rows and columns, where it lies in the map frame."""
    _, x, y, yaw = saved.header["frame"]
    turned = affinity.rotate(shape, yaw, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, x, y)


def _cells(saved):
    a = saved.header["frame"][0]
    return [
        _to_world(saved, shapely.box(c * a, r * a, (c + 1) * a, (r + 1) * a))
        for r, c in np.argwhere(saved.arrays["values"] >= OCCUPIED_FROM)
    ]


def _border(saved):
    a, (rows, columns) = saved.header["frame"][0], saved.arrays["values"].shape
    return _to_world(saved, shapely.box(0, 0, columns * a, rows * a)).exterior


def barn_cylinders(folder, number):
    """The cylinders (n, 3) of a BARN world: x, y, radius, from the original file."""
    with tarfile.open(folder / "worlds.tar.xz") as archive:
        file = archive.extractfile(f"worlds/world_{number}.world")
        world = ElementTree.fromstring(file.read()).find("world")
    cylinders = []
    for model in world.findall("model"):
        radius = model.find(".//collision//cylinder/radius")
        if radius is not None:
            x, y = map(float, model.find("pose").text.split()[:2])
            cylinders.append((x, y, float(radius.text)))
    return cylinders


def barn_score(saved, folder, number, success):
    """The score of the BARN challenge: OT / clip(time, 2 OT, 8 OT), 0 for a failure."""
    cells = np.load(folder / "path_files" / f"path_{number}.npy")
    path = np.column_stack([0.15 * cells[:, 0] - 4.575, 0.15 * cells[:, 1] + 5.075])
    path = np.vstack([(-2.25, 3.0), path, (-2.25, 13.0)])
    optimal = np.hypot(*np.diff(path, axis=0).T).sum() / 2.0
    times, places = saved.arrays["times"], saved.arrays["poses"][:, :2]
    moved = [t for t, p in zip(times, places, strict=True) if math.dist(p, places[0]) >= 0.1]
    there = [t for t, p in zip(times, places, strict=True) if math.dist(p, (-2.25, 13.0)) <= 1.0]
    if not success or not there or there[0] - moved[0] >= 100.0:
        return 0.0
    return optimal / min(max(there[0] - moved[0], 2.0 * optimal), 8.0 * optimal)
