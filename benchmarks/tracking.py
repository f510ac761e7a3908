"""How well people are tracked: CLEAR MOT figures [Bernardin2008] over the recorded crowds.

    python benchmarks/tracking.py --data DIR

A lidar moves through each recording at 0.6 m/s along planned ways, whatever is in its way, and the
tracks are compared with the recorded people, of whom it sees the bodies, then again the legs. A
person counts who walks, is more than half a metre away, and on whom three beams end. A track is right
within half a metre of a person, the same track as long as it is. MOTA is 1 less the missed, the false
and the switched over the people that count.
"""

import argparse
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from dynastar.bench.missions import Options
from dynastar.bench.suites import crowd
from dynastar.geometry import Pose2D, Twist, compose
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.sensing import Sensing
from dynastar.perception import PlanningMap
from dynastar.perception.tracking import Track
from dynastar.planning import plan
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario, World
from dynastar.simulation.movers import Movers

Floats = npt.NDArray[np.float64]

SPEED, PERIOD, LONGEST = 0.6, 0.05, 40.0  # m/s, s, s
FIRST = 1.0  # s from which on it counts
GATE, NEAR = 0.5, 0.5  # m
WALKS = 0.3  # m/s
BEAMS = 3
BODY, FEET = 0.3, 0.45  # m from a person's centre that a beam on the body, on the feet ends within
SEEN_NOW = 0.35  # s: a track is false if it was seen since then and is of nobody
EVERY = 8  # ways of the suite crowd, of which one is taken


class Look(NamedTuple):
    """What one scan came to; ``errors`` (m, m/s) are of the tracks that are right."""

    people: int
    missed: int
    false: int
    switched: int
    errors: list[tuple[float, float]]


def looks(scenario: Scenario) -> Iterator[Look]:
    """Move the lidar along the way of a scenario, and compare after each scan."""
    world, goal = World(scenario), scenario.goals[0]
    radius = scenario.robot.footprint.circumscribed
    path = plan(scenario.grid, scenario.start[:2], (goal.x, goal.y), "auto", radius).path
    sensing = Sensing(scenario.robot, NavigatorConfig(), PlanningMap(scenario.grid))
    people, known = Movers(scenario.movers), dict[int, int]()
    for k in range(round(min(path.length / SPEED, LONGEST) / PERIOD)):
        time, s = k * PERIOD, k * PERIOD * SPEED
        (x, y), (ahead_x, ahead_y) = path.at(s), path.at(min(s + 0.3, path.length))
        world.time, world.pose = time, Pose2D(x, y, math.atan2(ahead_y - y, ahead_x - x))
        scan = world.scan()
        state = world.sensed_state()._replace(twist=Twist(SPEED, 0.0))
        sensing.perceive(state, scan, None)
        if time < FIRST:
            continue
        places = people.at(time)
        velocities = (people.at(time + 0.2) - people.at(time - 0.2)) / 0.4
        ends = ends_of(scan, world.pose)
        reach = FEET if scenario.legs else BODY
        beams = np.array([(np.hypot(*(ends - place).T) < reach).sum() for place in places])
        away = np.hypot(*(places - (x, y)).T)
        counts = (beams >= BEAMS) & (np.hypot(*velocities.T) > WALKS) & (away > NEAR)
        tracks = [track for track in sensing.tracker.tracks if track.state != "tentative"]
        yield compared(tracks, places, velocities, counts, known)


def ends_of(scan: LaserScan, pose: Pose2D) -> Floats:
    """Where the beams of a scan end (n, 2), map frame, m."""
    sensor, ranges = compose(pose, scan.mount), np.asarray(scan.ranges)
    hit = np.isfinite(ranges) & (ranges < scan.range_max)
    angles = sensor.theta + scan.angle_min + scan.angle_increment * np.flatnonzero(hit)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.asarray((sensor.x, sensor.y) + ranges[hit, None] * directions)


def compared(
    tracks: Sequence[Track],
    places: Floats,
    velocities: Floats,
    counts: npt.NDArray[np.bool_],
    known: dict[int, int],
) -> Look:
    """Match tracks and people; ``known`` has the id of each person's last track, and is updated."""
    pairs = matched(tracks, places, known)
    switched = sum(known.get(person, track.id) != track.id for person, track in pairs.items())
    known.update({person: track.id for person, track in pairs.items()})
    used = {track.id for track in pairs.values()}
    false = sum(track.id not in used and track.unseen < SEEN_NOW for track in tracks)
    missed = sum(bool(counts[person]) and person not in pairs for person in range(len(places)))
    errors = [
        (
            math.dist((track.x, track.y), places[person]),
            math.dist((track.vx, track.vy), velocities[person]),
        )
        for person, track in pairs.items()
        if counts[person]
    ]
    return Look(int(counts.sum()), missed, false, switched, errors)


def matched(tracks: Sequence[Track], places: Floats, known: dict[int, int]) -> dict[int, Track]:
    """The track of each person: the one before while it is near enough, else by the least distances."""
    there = [int(person) for person in np.flatnonzero(np.isfinite(places[:, 0]))]
    gaps = {
        (person, track.id): math.dist((track.x, track.y), places[person])
        for person in there
        for track in tracks
    }
    by_id = {track.id: track for track in tracks}
    pairs = {
        person: by_id[known[person]]
        for person in there
        if gaps.get((person, known.get(person, -1)), math.inf) < GATE
    }
    used = {track.id for track in pairs.values()}
    left, free = [p for p in there if p not in pairs], [t for t in tracks if t.id not in used]
    if left and free:
        costs = np.array([[min(gaps[p, t.id], 10.0 * GATE) for t in free] for p in left])
        for i, j in zip(*linear_sum_assignment(costs), strict=True):
            if costs[i, j] < GATE:
                pairs[left[i]] = free[j]
    return pairs


def row(name: str, found: Sequence[Look]) -> str:
    """A line of the table."""
    people, missed, false, switched = (
        sum(getattr(look, what) for look in found) for what in Look._fields[:4]
    )
    places, speeds = np.array([error for look in found for error in look.errors]).T
    cells = (
        name,
        f"{people * PERIOD / 60.0:.1f}",
        f"{missed / people:.3f}",
        f"{false / len(found):.2f}",
        f"{switched / (people * PERIOD / 60.0):.1f}",
        f"{1.0 - (missed + false + switched) / people:.2f}",
        f"{places.mean():.2f}",
        f"{math.sqrt((speeds**2).mean()):.2f}",
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, help="with the folder pedestrians")
    data = parser.parse_args().data
    heads = ("recording, seen", "minutes", "missed", "false at a time", "switches a minute", "MOTA")
    print(f"| {' | '.join((*heads, 'place, m', 'velocity, m/s'))} |")
    for legs in (False, True):
        found = defaultdict[str, list[Look]](list)
        for mission in crowd.missions(Options(data=data)):
            if mission.number % EVERY == 1 and not crowd.leave_out(mission, Options(data=data)):
                made = crowd.scenario(mission, Options(data=data), 0)
                made = replace(made, legs=legs, attention="none")
                found[Path(mission.spec[0]).stem] += looks(made)
        found["all"] = [look for of in found.values() for look in of]
        for name, of in found.items():
            print(row(f"{name}, {'legs' if legs else 'bodies'}", of), flush=True)


if __name__ == "__main__":
    main()
