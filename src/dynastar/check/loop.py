"""Findings on time: how long a tick takes on this computer, and the delays that are declared."""

from time import perf_counter

import numpy as np
import numpy.typing as npt

from dynastar.check.finding import Finding, Level, at_least, worst
from dynastar.check.stopping import stop_from
from dynastar.geometry import Goal, Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState
from dynastar.robot import Robot
from dynastar.simulation import Mover, Scenario, World, warm_up

SECONDS = 5.0  # simulated
MOST_TICKS = 100
LONGEST = 10.0  # s that the ticks may take in all
SIDE, CELL = 12.0, 0.1  # m of the hall, for a robot of RADIUS
RADIUS = 0.3
BUSY = 0.5  # of the period that a tick may take
SLOW_SHARE = 95  # percentile of the ticks that counts
ROUNDED = 1e-9  # of a period that was calculated

Floats = npt.NDArray[np.float64]


def tick_times(robot: Robot, config: NavigatorConfig) -> Floats:
    """Milliseconds of each tick of a drive through a generated hall, past boxes and two walkers.

    Where ticks are very slow, there are fewer of them.
    """
    warm_up()
    scenario = _hall(robot, config)
    world = World(scenario, Pose2D(*scenario.start[:2], 0.0))
    navigator = Navigator(scenario.grid, robot, config)
    navigator.set_goal(scenario.goals)
    ticks = min(MOST_TICKS, max(1, round(SECONDS / config.period)))
    times: list[float] = []
    while len(times) < ticks and sum(times) < 1e3 * LONGEST:
        state, scan = RobotState(world.time, world.pose, world.twist), world.scan()
        began = perf_counter()
        command = navigator.command(state, scan)
        times.append(1e3 * (perf_counter() - began))
        world.step(command, config.period)
    return np.array(times)


def _hall(robot: Robot, config: NavigatorConfig) -> Scenario:
    """A hall with boxes and walkers, in proportion to the robot where that is large."""
    scale = max(1.0, robot.footprint.circumscribed / RADIUS)
    n = round(SIDE / CELL)
    occupied = np.pad(np.zeros((n - 2, n - 2), bool), 1, constant_values=True)
    grid = OccupancyGrid.from_occupied(occupied, scale * CELL)
    square = np.array([(-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3)])
    middles = [(3.0, 6.5), (5.5, 4.5), (5.5, 8.0), (8.0, 6.3), (8.5, 9.5), (3.0, 9.5), (8.5, 3.0)]
    walkers = [((10.0, 5.2), (2.0, 5.6)), ((6.8, 10.0), (6.8, 2.0))]
    return Scenario(
        "hall",
        grid,
        robot,
        (1.5 * scale, 6.0 * scale, 0.0),
        (Goal(10.5 * scale, 6.0 * scale),),
        obstacles=tuple(scale * (square + middle) for middle in middles),
        movers=tuple(
            Mover(0.3, np.array([0.0, 8.0]), scale * np.array(way), "back_and_forth")
            for way in walkers
        ),
        latency=config.latency,
    )


def loop(milliseconds: Floats, period: float) -> Finding:
    """Whether ticks, which took so long, leave time within the period (s)."""
    middle, slow = (float(np.percentile(milliseconds, share)) for share in (50, SLOW_SHARE))
    text = (
        f"On this computer a tick takes {middle:.1f} ms, and {SLOW_SHARE} of 100 take at most "
        f"{slow:.1f} ms, of a period of {1e3 * period:g} ms."
    )
    values = {"median_ms": middle, "slow_ms": slow, "period": period}
    if slow <= BUSY * 1e3 * period:
        return Finding("loop", "ok", text, "", values)
    level: Level = "problem" if slow > 1e3 * period else "warning"
    advice = (
        f"Declare period = {at_least(2e-3 * slow)} or more, or save time: larger resolution, smaller "
        "local_map.size, fewer samples."
    )
    return Finding("loop", level, text, advice, values)


def delays(robot: Robot, config: NavigatorConfig) -> Finding:
    """Whether period, latency and scan_age go together."""
    period, latency, age = config.period, config.latency, config.scan_age
    stop = stop_from(robot.limits.v_max, robot.limits, config)
    text = (
        f"A command is given every {period:g} s and acts after {latency:g} s at the latest, which is "
        f"{stop.reaction:.2f} m at v_max; the robot brakes if scans are older than {age:g} s."
    )
    level: Level = "ok"
    advice = []
    if age < (2.0 - ROUNDED) * period:
        level = worst(level, "problem" if age <= period else "warning")
        advice.append(
            f"Declare scan_age = {at_least(2.0 * period)} or more, or the robot brakes for nothing."
        )
    if latency == 0.0:
        level = worst(level, "warning")
        advice.append("No drive acts at once: measure latency, and declare it.")
    values = {"period": period, "latency": latency, "scan_age": age, "reaction": stop.reaction}
    return Finding("delays", level, text, " ".join(advice), values)
