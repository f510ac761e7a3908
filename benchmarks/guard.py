"""How much a guard slows a controller down that needs none.

In the worlds of the suite bounds, goals are drawn that can be seen from the start. A controller drives
straight to each: alone, behind a guard, and behind Nav2's default zones. Where it arrives alone, the
share of its speed that the others lose is 1 - (time alone) / (time with them).

    python benchmarks/guard.py --missions 200
"""

import argparse
import math
from dataclasses import replace
from itertools import count

import numpy as np

from dynastar.bench.controllers.guarded import GuardedStraight, MonitoredStraight, Straight
from dynastar.bench.missions import Mission, Options
from dynastar.bench.statistics import bootstrap
from dynastar.bench.suites import bounds
from dynastar.geometry import Goal
from dynastar.simulation import Scenario, World, drive, warm_up

NEAREST, FARTHEST = 2.0, 8.0  # m from the start to a goal
ROOM = (0.05, 0.5)  # m beside the footprint's disc on the way, drawn for each mission
TRIES = 200  # goals drawn in a world
NOBODY = {"hidden_speed": 0.0}
ARMS = (
    ("guarded", GuardedStraight, {}),
    ("guarded, nobody steps out", GuardedStraight, NOBODY),
    ("Nav2's zones", MonitoredStraight, {}),
)


def seen_goal(scenario: Scenario, random: np.random.Generator) -> Goal | None:
    """A goal to which the way is straight and has the drawn room, or None."""
    world = World(scenario)
    x, y, _ = world.pose
    clear = scenario.robot.footprint.circumscribed + random.uniform(*ROOM)
    for _ in range(TRIES):
        angle, distance = random.uniform(-math.pi, math.pi), random.uniform(NEAREST, FARTHEST)
        along = np.arange(0.0, distance, 0.02)[:, None]
        line = np.array([x, y]) + along * np.array([math.cos(angle), math.sin(angle)])
        if world.gaps(line).min() > clear:
            return Goal(*line[-1])
    return None


def missions(n: int, seed: int) -> list[Scenario]:
    """The first ``n`` missions in which there is such a goal and the controller alone arrives."""
    found: list[Scenario] = []
    options = Options(seed=seed)
    for number in count():
        mission = Mission(number)
        if len(found) == n:
            break
        if bounds.leave_out(mission, options):
            continue
        made = bounds.scenario(mission, options, 0)
        goal = seen_goal(made, np.random.default_rng([seed, number]))
        if goal is not None:
            found.append(replace(made, goals=(goal,), time_limit=120.0))
    return found


def with_settings(scenario: Scenario, settings: dict[str, float]) -> Scenario:
    """The scenario with some of the navigator's settings replaced."""
    return replace(scenario, navigator={**scenario.navigator, **settings})


def main() -> None:
    """Runs all and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--missions", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    warm_up()
    chosen = missions(arguments.missions, arguments.seed)
    alone = [drive(scenario, navigator=Straight) for scenario in chosen]
    safe = [k for k, episode in enumerate(alone) if episode.outcome == "arrived"]
    print(f"{len(chosen)} missions; alone it arrives in {len(safe)}, contacts in the others")
    for name, controller, settings in ARMS:
        ends = [drive(with_settings(one, settings), navigator=controller) for one in chosen]
        contacts = sum(end.outcome == "contact" for end in ends)
        arrived = [k for k in safe if ends[k].outcome == "arrived"]
        lost = [1.0 - alone[k].trajectory.times[-1] / ends[k].trajectory.times[-1] for k in arrived]
        low, high = bootstrap(lost) or (math.nan, math.nan)
        print(
            f"{name:26} arrives in {len(arrived)} of these {len(safe)}, loses {np.mean(lost):.1%} "
            f"({low:.1%} to {high:.1%}) of the speed, median {np.median(lost):.1%}; {contacts} contacts"
        )


if __name__ == "__main__":
    main()
