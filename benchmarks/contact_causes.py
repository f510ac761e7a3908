"""Causes of the navigator's contacts while moving: drives these missions again and looks at who was hit.

Reads the results of the suites in the folder of --json-out, as `make results` left them there. The cause is
read off the truth. From seeing somebody until it stands a robot needs a tick, its latency, and its braking
time from the greatest speed of the last seconds: its stopping time.

python benchmarks/contact_causes.py --seed 10000 --json-out out/results/contact_causes.json
"""

import argparse
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar import io
from dynastar.bench.keeping import mission_numbered, replay
from dynastar.bench.missions import Options
from dynastar.bench.suites import load_suite
from dynastar.bench.suites.common import touched_mover
from dynastar.bench.workers import completed
from dynastar.episode import Episode
from dynastar.geometry import Pose2D, compose
from dynastar.simulation import Scenario
from dynastar.simulation.lidar import LidarSimulator

Floats = npt.NDArray[np.float64]

PARTS = {  # with people or discs that move: their suite
    "people_late": "people",
    "people_none": "people",
    "people_reactive": "people",
    "crowd_late": "crowd",
    "crowd_none": "crowd",
    "dynabarn": "dynabarn",
    "dynabarn_slow": "dynabarn",
    "crowdnav": "crowdnav",
    "crowdnav_variants": "crowdnav",
    "office": "office",
    "maps": "maps",
    "navground": "navground",
    "mrpb": "mrpb",
    "table3": "paper",
}
BEFORE = 3.0  # s before the contact in which the robot's greatest speed is looked for
SEEN = 1.0  # s before the stopping time in which a reading must have hit the person
STEADY = 0.5  # s before the stopping time whose mean velocity is what the person might have kept
STRAYED = 0.3  # m between where that would have led and the place of the contact
HIT = 0.03  # m between the end of a reading and the person's outline
JUMP = 0.5  # m between two ticks, which nobody walks: a disc of DynaBARN begins its way anew
CAUSES = {
    "appeared": "appeared, or jumped, within the stopping time",
    "hidden": "was hidden until the robot could not stop any more",
    "not looked": "came from where the lidar does not look",
    "turned": "turned, stopped, started or changed pace within the stopping time",
    "slowed": "walked on steadily into a robot that was slowing down or reversing",
    "drove on": "walked on steadily, and the robot drove on",
    "at rest": "was no person: something at rest",
}


class Job(NamedTuple):
    """A mission that ended with a contact while moving."""

    part: str
    suite: str
    number: int
    group: str
    options: Options


def hits(episode: Episode, lidar: LidarSimulator, tick: int, person: int) -> tuple[bool, bool]:
    """Whether a reading of a scan hits the person, and whether the lidar looks that way."""
    pose = Pose2D(*map(float, episode.trajectory.poses[tick]))
    discs = np.column_stack([episode.movers[tick], episode.mover_radii]).astype(np.float64)
    scan = lidar.scan(pose, 0.0, discs)
    sensor = compose(pose, lidar.lidar.mount)
    angles, place = scan.angles + sensor.theta, np.array([sensor.x, sensor.y])
    ends = place + scan.ranges[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    x, y, radius = discs[person]
    gap = np.abs(np.hypot(ends[:, 0] - x, ends[:, 1] - y) - radius)
    bearing = np.arctan2(y - sensor.y, x - sensor.x) - sensor.theta
    off = abs((bearing + np.pi) % (2.0 * np.pi) - np.pi)
    return bool((gap < HIT).any()), bool(off <= 0.5 * lidar.lidar.fov)


def examined(episode: Episode, scenario: Scenario) -> dict[str, Any]:
    """The cause of the contact at an episode's end, with the figures that it is read off."""
    times, speeds = episode.trajectory.times, episode.trajectory.twists[:, 0]
    end, limits = times[-1], scenario.robot.limits
    person = touched_mover(episode)
    if person is None:
        return {"cause": "at rest", "speed": float(speeds[-1])}
    fastest = float(np.abs(speeds[times >= end - BEFORE]).max())
    period = float(np.median(np.diff(times)))
    stopping = period + scenario.latency + fastest / limits.v_brake
    noticed, steady = end - stopping, (times >= end - stopping - STEADY) & (times <= end - stopping)
    place = episode.movers[:, person]
    appeared = (
        not (np.diff(place[times >= noticed - SEEN], axis=0) ** 2).sum(axis=1).max() < JUMP**2
    )
    strayed = 0.0
    if np.count_nonzero(steady) > 1 and not appeared:
        first, last = np.flatnonzero(steady)[[0, -1]]
        velocity = (place[last] - place[first]) / (times[last] - times[first])
        strayed = float(np.hypot(*(place[-1] - place[last] - velocity * (end - times[last]))))
    world = scenario.grid if scenario.world is None else scenario.world
    lidar = LidarSimulator(scenario.robot.lidar, world, episode.obstacles)
    window = np.flatnonzero((times >= noticed - SEEN) & (times <= max(noticed, times[0])))
    seen, looked = zip(*(hits(episode, lidar, tick, person) for tick in window), strict=True)
    speed = float(speeds[-1])
    cause = "drove on"
    if appeared:
        cause = "appeared"
    elif not any(seen):
        cause = "hidden" if any(looked) else "not looked"
    elif strayed > STRAYED:
        cause = "turned"
    elif speed < 0.5 * fastest:
        cause = "slowed"
    return {
        "cause": cause,
        "stopping_time": stopping,
        "strayed": strayed,
        "speed": speed,
        "fastest": fastest,
        "seen": float(np.mean(seen)),
    }


def examine(job: Job) -> dict[str, Any]:
    """Drives a mission again; its row."""
    suite, options = load_suite(job.suite), job.options
    row, episode = replay(job.suite, suite, options, job.number, 0)
    of = {"part": job.part, "suite": job.suite, "number": job.number, "group": job.group}
    if not row["contacts_moving"]:
        raise SystemExit(f"{job.suite} {job.number} ends differently when it is driven again")
    mission = mission_numbered(job.suite, suite, options, job.number)
    scenario: Scenario = suite.scenario(mission, options, 0)  # type: ignore[attr-defined]
    return of | examined(episode, scenario)


def rows_of(result: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The rows of a part's missions; of Table III those of the default."""
    rows = result["rows"]
    return list(rows["table3-default"] if isinstance(rows, Mapping) else rows)


def jobs(folder: Path, seed: int) -> list[Job]:
    """The missions of all parts that ended with a contact while moving."""
    found = []
    for part, suite in PARTS.items():
        if not (file := folder / f"{part}.json").is_file():
            continue  # its extra is not installed
        result = json.loads(file.read_text(encoding="utf-8"))
        walks_on = suite in ("people", "crowd") and result["attention"] == "none"
        options = Options(seed=seed, attention="none" if walks_on else None)
        found += [
            Job(part, suite, row["number"], row.get("group", ""), options)
            for row in rows_of(result)
            if row.get("contacts_moving")
        ]
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--json-out", type=Path, required=True, metavar="FILE")
    parser.add_argument("--missions", type=int, metavar="N", help="so many: a trial")
    arguments = parser.parse_args()
    asked = jobs(arguments.json_out.parent, arguments.seed)[: arguments.missions]
    rows = dict(completed(examine, asked, os.cpu_count() or 1))
    io.write_json(arguments.json_out, {"rows": [rows[index] for index in sorted(rows)]})
