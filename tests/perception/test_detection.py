import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from dynastar.grid import GridFrame
from dynastar.perception import detection as d
from dynastar.perception.detection import FIRST, LAST, NEITHER, UNOWNED, Known
from dynastar.perception.past_scans import SENSOR, SeenFree
from dynastar.perception.placed_scan import PlacedScan, Sensor
from dynastar.perception.tracking_kernels import TRACK

STEP = 0.005
HERE = Sensor(1.0, 0.0, 0.0, 0.0, 0.0, STEP, 1257, True)
NO_TRACKS = np.zeros(0, TRACK)
NOTHING = Known(np.zeros((1, 1), bool), GridFrame(1.0, 1000.0, 1000.0))


def disc_points(distance, radius, low=-math.inf, high=math.inf):
    """Where beams from the origin hit a disc at (distance, 0), between two angles."""
    edge = math.asin(radius / distance)
    angles = np.arange(math.ceil(-edge / STEP), math.floor(edge / STEP) + 1) * STEP
    angles = angles[(angles >= low) & (angles <= high)]
    off = np.maximum(radius**2 - (distance * np.sin(angles)) ** 2, 0.0)
    ranges = distance * np.cos(angles) - np.sqrt(off)
    return np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)])


def fitted(ends, radius, hidden=NEITHER):
    """The disc that fits a group of all the points."""
    points, (group,) = np.zeros(len(ends), d.POINT), np.zeros(1, d.GROUP)
    points["x"], points["y"] = ends.T
    points["range"] = np.hypot(*ends.T)
    group["stop"] = len(ends)
    group["hidden"] = hidden
    return fit(points, group, HERE, radius)


@njit
def fit(points, group, sensor, radius):
    return d.fit_disc(points, group, sensor, radius)


def space(free):
    """What a scan from the origin saw free: as far out as ``free(x, y)``, up to 6 m."""
    angles = (np.arange(1257) + 0.5) * STEP
    along = np.arange(0.0, 6.0, 0.01)
    shown = free(np.cos(angles)[:, None] * along, np.sin(angles)[:, None] * along)
    ranges = along[np.where(shown.all(axis=1), -1, np.argmin(shown, axis=1))]
    return SeenFree(np.array([HERE], SENSOR), ranges[None, :])


def everywhere(x, y):
    return np.full(np.broadcast(x, y).shape, True)


def nowhere(x, y):
    return ~everywhere(x, y)


def groups_of(points, free=everywhere, known=NOTHING, tracks=NO_TRACKS):
    """Groups of points in any order; their indices are in the order of the angles."""
    angles = np.arctan2(points[:, 1], points[:, 0])
    order = np.argsort(angles)
    beams = np.round((angles[order] + math.pi) / STEP).astype(np.int64)
    scan = PlacedScan(HERE, np.zeros(HERE.beams), points[order], beams)
    groups, found = d.find_groups(d.points_of(scan), HERE, known, space(free), tracks, 1.4)
    assert sorted(found["beam"]) == beams.tolist()
    return groups


@given(st.floats(0.1, 1.0), st.floats(0.05, 0.7))
@settings(deadline=None)
def test_a_disc_in_full_view_is_found_with_its_radius(radius, sin):
    distance = radius / sin
    points = disc_points(distance, radius)
    x, y, seen = fitted(points, 0.0)
    error = 0.03 * radius + 2.0 * STEP * distance
    assert (x, y, seen) == pytest.approx((distance, 0.0, radius), abs=error)


@given(st.floats(0.5, 4.0), st.floats(0.15, 0.5), st.floats(-0.5, 0.6), st.booleans())
@settings(deadline=None)
def test_a_disc_of_known_radius_is_found_by_one_of_its_ends(gap, radius, shown, mirrored):
    """However much of it is hidden: ``shown`` is where the hidden part begins."""
    distance = radius + gap
    points = disc_points(distance, radius, low=shown * math.asin(radius / distance))
    if len(points) < 3:
        return
    if mirrored:  # the last end is the hidden one
        points = (points * (1.0, -1.0))[::-1].copy()
    x, y, _ = fitted(points, radius, LAST if mirrored else FIRST)
    assert math.hypot(x - distance, y) < 0.06 * radius + 2.0 * STEP * distance


@given(st.lists(st.tuples(st.floats(1.0, 5.0), st.integers(3, 40)), min_size=1, max_size=12))
@settings(deadline=None)
def test_groups_break_where_neighbours_are_far_apart(arcs):
    """Against a naive split of arcs, each at one range from the sensor."""
    ranges = np.concatenate([np.full(count, r) for r, count in arcs])
    angles = -3.0 + np.arange(len(ranges)) * STEP
    points = np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)])
    found = groups_of(points)
    expected, group = [], [0]
    for i in range(1, len(points)):
        if math.dist(points[i], points[i - 1]) > 0.2 + 2.0 * ranges[i] * STEP:
            expected.append(group)
            group = []
        group.append(i)
    expected.append(group)

    def spans(width):
        return {
            (g[0], g[-1] + 1) for g in expected if math.dist(points[g[0]], points[g[-1]]) < width
        }

    got = {(int(g["start"]), int(g["stop"])) for g in found if g["radius"] < 0.6}
    assert {g for g in spans(0.5) if g[1] - g[0] >= d.FEWEST} <= got <= spans(1.4)


def test_ends_are_hidden_behind_what_is_nearer():
    far = disc_points(4.0, 0.3)
    near = disc_points(2.0, 0.2) @ np.array(
        [[math.cos(0.12), math.sin(0.12)], [-math.sin(0.12), math.cos(0.12)]]
    )
    hidden = np.arctan2(far[:, 1], far[:, 0]) > np.arctan2(near[:, 1], near[:, 0]).min()
    found = groups_of(np.vstack([far[~hidden], near]))
    last, first = np.sort(found, order="x")
    assert (first["hidden"], last["hidden"]) == (LAST, NEITHER)
    assert (first["x"], first["y"]) == pytest.approx((4.0, 0.0), abs=0.04)


def test_points_at_what_the_map_shows_are_in_no_group():
    mapped = np.zeros((20, 20), bool)
    mapped[:, 10:] = True  # x from 0 on
    known = Known(mapped, GridFrame(1.0, -10.0, -10.0))
    assert len(groups_of(disc_points(2.0, 0.3))) == 1
    assert len(groups_of(disc_points(2.0, 0.3), known=known)) == 0


def test_free_space_is_what_lies_behind_a_point():
    """A wall is not in free space, though noise may have let a beam pass its surface."""
    y = np.linspace(-0.4, 0.4, 60)
    wall = np.column_stack([np.full(60, 2.02), y])
    (group,) = groups_of(wall, free=lambda x, y: (x < 2.05) & (y == y))
    assert group["free"] == 0.0
    (group,) = groups_of(wall)
    assert group["free"] == 1.0


@pytest.mark.parametrize("entered", [True, False])
def test_of_what_is_too_wide_only_what_entered_free_space_is_a_group(entered):
    """A disc of radius 0.25 m in front of a wall, joined to it."""
    y = np.linspace(-2.0, 2.0, 400)
    wall = np.column_stack([np.full(400, 2.3), y])
    disc = disc_points(2.2, 0.25)
    aside = np.abs(np.arctan2(y, 2.3)) > math.asin(0.25 / 2.2)
    free = (lambda x, y: (x < 2.25) & (y == y)) if entered else nowhere
    found = groups_of(np.vstack([disc, wall[aside]]), free=free)
    assert len(found) == entered
    if entered:
        assert found["x"] == pytest.approx(2.2, abs=0.1)


def test_the_discs_of_two_tracks_that_touch_are_two_groups():
    """Without the expectation they are one, and it has no track."""
    pair = [disc_points(3.0, 0.3) @ _turn(a) for a in (-0.1, 0.1)]
    tracks = np.zeros(2, TRACK)
    tracks["x"], tracks["y"] = 3.0 * math.cos(0.1), 3.0 * math.sin(0.1) * np.array([-1.0, 1.0])
    tracks["radius"], tracks["margin"], tracks["measured"] = 0.3, 0.1, 1.0
    (group,) = groups_of(np.vstack(pair))
    assert group["owner"] == UNOWNED
    found = np.sort(groups_of(np.vstack(pair), tracks=tracks), order="owner")
    assert found["owner"].tolist() == [0, 1]
    assert found["x"] == pytest.approx(tracks["x"], abs=0.1)
    assert found["y"] == pytest.approx(tracks["y"], abs=0.1)


def _turn(angle):
    return np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])


def test_no_points_make_no_groups():
    assert len(groups_of(np.empty((0, 2)))) == 0
