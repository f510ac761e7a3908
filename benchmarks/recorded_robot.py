"""Draws robots, drives and records them by hand, and counts estimates that miss the truth.

python benchmarks/recorded_robot.py [--robots 100] [--seed 1000]
python benchmarks/recorded_robot.py --physics

For docs/how-to/tune.md. Robot n is drawn from seed + n. With --physics MuJoCo moves the robots of the suite
of that name, and their stops from 80 and 40 % of the full speed are compared with those of the file. Needs
the extras bags and physics.
"""

import argparse
import sys
import tempfile
from collections import Counter
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from dynastar.geometry import Pose2D, Twist
from dynastar.simulation import Noise, Scenario
from dynastar.simulation.imperfections import Drivetrain, Odometry
from dynastar.tune.measured import measured
from dynastar.tune.recording import read_drive

TESTS = Path(__file__).parent.parent / "tests"
sys.path[:0] = [str(TESTS), str(TESTS / "tune")]
from test_measured import PLAIN, SLOW, truth_of  # noqa: E402

from scripted_drive import by_hand, record  # noqa: E402


def drawn(seed: int) -> Scenario:
    """A robot: its limits, latency, gains, dead bands and errors; each fault in some robots only."""
    random = np.random.default_rng(seed)
    draw, rare = random.uniform, random.random(4) < (0.5, 0.33, 0.25, 0.2)
    banded, jitters, odometry_errs, poses_err = rare
    limits = PLAIN.robot.limits._replace(
        v_accel=draw(0.2, 2.0),
        v_brake=draw(0.2, 2.0),
        omega_accel=draw(0.5, 4.0),
        omega_brake=draw(0.5, 4.0),
    )
    drive = Drivetrain(
        gain_v=draw(0.8, 1.15),
        gain_omega=draw(0.8, 1.2),
        deadband_v=draw(0.0, 0.1) * banded,
        deadband_omega=draw(0.0, 0.2) * banded,
        latency_jitter=draw(0.0, 0.1) * jitters,
    )
    gains = draw(0.9, 1.1, 2) if odometry_errs else np.ones(2)
    return replace(
        PLAIN,
        robot=replace(PLAIN.robot, limits=limits),
        latency=draw(0.0, 0.3),
        drive=drive,
        odometry=Odometry(gain_v=float(gains[0]), gain_omega=float(gains[1])),
        noise=Noise(draw(0.0, 0.05), pose_bound=0.01 * poses_err, heading_bound=0.01 * poses_err),
    )


def stops() -> None:
    """Prints for each robot, floor and load how far it comes in a stop, and how far by its file."""
    from dynastar.bench.suites.physics import BODIES, FLOORS, GENTLE, LATENCY
    from dynastar.bench.suites.physics_world import PhysicsWorld

    for (robot, body), floor, loaded in product(BODIES, FLOORS, (False, True)):
        limits = robot.limits._replace(**GENTLE, v_min=-robot.limits.v_max)
        scenario = replace(
            PLAIN, robot=replace(robot, limits=limits), latency=LATENCY, noise=Noise(0.01)
        )
        world = partial(PhysicsWorld, body=body, floor=floor, loaded=loaded)
        script = by_hand(0.8 * limits.v_max, 0.8 * limits.omega_max)
        with tempfile.TemporaryDirectory() as folder:
            record(Path(folder) / "bag", scenario, script, make_world=world)
            found = measured(read_drive(Path(folder) / "bag"), scenario.robot).estimates
        latency, brake = found["latency"], found["v_brake"]
        words = [f"{robot.name}, friction {floor:g}, {'with' if loaded else 'without'} payload:"]
        for part in (0.8, 0.4):
            driven = world(scenario, Pose2D(6.0, 6.0, 0.0), 0)
            for _ in range(60):
                driven.step(Twist(part * limits.v_max, 0.0), 0.05)
            speed, began = driven.twist.v, driven.pose.x
            for _ in range(100):
                driven.step(Twist(0.0, 0.0), 0.05)
            told = speed * latency.high + 0.5 * speed**2 / brake.low
            words.append(
                f"{speed:.2f} m/s {driven.pose.x - began:.3f} m, by the file {told:.3f} m;"
            )
        print(*words, f"latency {latency.high:.3f} s, v_brake {brake.low:.2f} m/s2")


def main() -> None:
    """Prints every estimate whose range does not hold the truth, and how many there are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--physics", action="store_true")
    given = parser.parse_args()
    if given.physics:
        stops()
        return
    counts: Counter[str] = Counter()
    for seed in range(given.seed, given.seed + given.robots):
        scenario = drawn(seed)
        truth = truth_of(scenario)
        random = np.random.default_rng((seed, 1))
        odometry = {"noise": random.uniform(0.0, 0.005) * (random.random() < 0.5)}
        if scenario.drive.latency_jitter == 0.0:  # which is drawn for each step of the world
            odometry["per_command"] = int(random.choice((1, 2, 5)))
        with tempfile.TemporaryDirectory() as folder:
            record(Path(folder) / "bag", scenario, by_hand(0.5, 1.2, **SLOW), **odometry)
            found = measured(read_drive(Path(folder) / "bag"), scenario.robot)
        for name, estimate in found.estimates.items():
            if not estimate.told:
                counts["not told"] += 1
            elif estimate.low - 1e-9 <= truth[name] <= estimate.high + 1e-9:
                counts["held"] += 1
            else:
                counts["missed"] += 1
                print(f"robot {seed}: {name} is {truth[name]:g}; {estimate.words()}")
    print(f"{given.robots} robots: {dict(counts)}")


if __name__ == "__main__":
    main()
