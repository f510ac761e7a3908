"""Suite bounds: the worlds of the suite random, with all declared errors as large as they may be.

Ranges are off by up to 2 cm, x and y of the pose by 2 cm each and its heading by 0.01 rad, drawn anew
each time. The drive is 5 % fast or slow in each of its speeds, odometry tells them 5 % high or low, and
a command acts after up to 0.1 s. All that is declared, no more. Nothing moves but the robot.

The suite is meant for contacts, and for controllers that ``dynastar.bench.controllers.guarded`` puts
behind a guard. The time limit is 2 times the least time of the shortest way, plus 20 s.
"""

from dataclasses import replace
from itertools import product
from typing import Any

from dynastar.bench import driven
from dynastar.bench.bound import least_time
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import random_worlds
from dynastar.episode import Episode
from dynastar.simulation import Drivetrain, Noise, Odometry, Scenario

DEFAULT_MISSIONS = 100
QUICK_MISSIONS = 18

COMPARABLE = random_worlds.COMPARABLE

NOISE = Noise(0.02, 0.02, 0.01)  # m, m, rad
LATENCY, PERIOD = 0.1, 0.1  # s
DRIVE_ERROR = 0.05
GAINS = tuple(product((1.0 - DRIVE_ERROR, 1.0 + DRIVE_ERROR), repeat=4))
PATIENCE, EXTRA_TIME = 2.0, 20.0  # times the least time, s

missions, leave_out = random_worlds.missions, random_worlds.leave_out
made_of = random_worlds.made_of


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The mission of a number; raises DataError for one that ``leave_out`` leaves out."""
    easier = random_worlds.scenario(mission, options, repeat)
    if options.ideal:
        return easier
    made = made_of(mission, options)
    drive_v, drive_omega, odometry_v, odometry_omega = GAINS[mission.number // 18 % len(GAINS)]
    return replace(
        easier,
        name=f"bounds {mission.number}: {made.kind.replace('_', ' ')}, {made.robot.name}",
        noise=NOISE,
        drive=Drivetrain(drive_v, drive_omega, latency_jitter=LATENCY),
        odometry=Odometry(odometry_v, odometry_omega),
        latency=LATENCY,
        time_limit=round(PATIENCE * least_time(made.length, made.robot.limits) + EXTRA_TIME, 1),
        navigator={"period": PERIOD, "drive_error": DRIVE_ERROR},
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission; a ``blocked`` that is right has the outcome ``blocked_rightly``."""
    made = made_of(mission, options)

    def extra(episode: Episode) -> dict[str, Any]:
        return random_worlds.verdict(episode, made.world.reachable)

    driven_scenario = scenario(mission, options, repeat)
    return driven.run_mission(
        driven_scenario, options, mission, repeat, group=made.kind, extra=extra
    )
