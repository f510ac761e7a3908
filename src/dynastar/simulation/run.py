"""Running a mission: the world, the navigator in it, and how it ends (section V)."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Any, Protocol

from dynastar.episode import Episode
from dynastar.errors import InputError, ScenarioError, StartOccupied
from dynastar.geometry import Pose2D, Twist, wrap_angle
from dynastar.planning.explain import explained, misfit
from dynastar.robot import stopping_time
from dynastar.simulation.fault_injector import FaultInjector
from dynastar.simulation.loop_timer import LoopTimer
from dynastar.simulation.record import Recorder
from dynastar.simulation.scenario import Scenario
from dynastar.simulation.start import start_pose
from dynastar.simulation.tracing import Tracer
from dynastar.simulation.warming import warm_up
from dynastar.simulation.world import World
from dynastar.terminal import progress_bar

SENSOR_LOST = 5.0  # s without usable data until a mission is given up
GRACE = 5.0  # s to come to rest after the last word, on top of the stopping time


class Controller(Protocol):
    """A controller in simulation: ``dynastar.Navigator``, or anything with the same interface.

    ``status`` needs ``state``, ``reason``, ``recoveries``, ``plan``, ``plan_id``, ``plan_reason``,
    ``planning_frame`` and ``error`` as the Navigator's has them; ``plan`` may stay None. An optional
    ``limited_by`` says in a word or two what limited the speed in this tick, "" for nothing. A
    controller may have ``explored``, the cells (m, 2) of ``planning_frame`` that its search expanded.
    """

    @property
    def status(self) -> Any:
        """State, reason and plan after the last command."""

    def set_goal(self, goal: Any) -> Any:
        """Takes the goals, in order."""

    def command(self, state: Any, scan: Any) -> Twist:
        """The twist to drive, given a RobotState and a LaserScan, or None where a fault lost it."""


def run(
    scenario: Scenario,
    progress: bool = False,
    seed: int | None = None,
    *,
    navigator: Callable[..., Controller] | None = None,
    trace: bool = False,
    make_world: Callable[[Scenario, Pose2D, int], World] = World,
) -> Episode:
    """``drive`` with warm kernels, so that ``command_ms`` tells what commands cost."""
    if navigator is None:
        warm_up()
    return drive(scenario, progress, seed, navigator=navigator, trace=trace, make_world=make_world)


def drive(
    scenario: Scenario,
    progress: bool = False,
    seed: int | None = None,
    *,
    navigator: Callable[..., Controller] | None = None,
    trace: bool = False,
    make_world: Callable[[Scenario, Pose2D, int], World] = World,
) -> Episode:
    """Runs a mission from its start to its end and returns the record of it.

    ``progress`` shows a bar on stderr, in simulated seconds. ``seed`` replaces the scenario's.
    ``navigator`` is called as ``navigator(grid, robot, config)`` for what drives, by default
    ``dynastar.Navigator``. ``trace`` keeps what it thought at each tick. ``make_world`` makes the true
    world of a scenario, a start and a seed. But for ``command_ms``, a seed gives the same Episode.

    Raises ConfigError and ScenarioError for settings and scenarios that cannot be, and
    StartOccupied, GoalOccupied or OutOfMap for a start or goal that the navigator cannot take.
    """
    from dynastar.navigator import Navigator

    if not scenario.goals:
        raise ScenarioError(f"the scenario '{scenario.name}' has no goal: expected one or more")
    seed = scenario.seed if seed is None else seed
    config = effective_config(scenario)
    world = make_world(scenario, start_pose(scenario), seed)
    controller = (navigator or Navigator)(scenario.grid, scenario.robot, config)
    controller.set_goal(scenario.goals)
    recorder, referee = Recorder(scenario, world, controller), Referee(scenario, config)
    faults = FaultInjector(scenario.faults, world, controller, recorder.event, seed)
    tracer = Tracer(controller) if trace else None
    ending, timer = None, LoopTimer(scenario.loop, config.period, seed)
    with _bar(scenario, progress) as bar:
        while ending is None:
            faults.begin()
            state, scan = faults.sensed(world.sensed_state(), world.scan())
            began = perf_counter()
            command = Twist(*controller.command(state, scan))
            command_ms = 1e3 * (perf_counter() - began)
            status = controller.status
            if world.time == 0.0 and status.error is not None:
                status = _explained(status, scenario)
            if world.time == 0.0 and status.state == "sensor_lost":  # in a wall it sees nothing
                _check_start(scenario)
            recorder.tick(command, command_ms, status)
            if tracer is not None:
                tracer.tick(status)
            ending = referee.ended(world, status)
            if ending is None:
                before = world.time
                world.step(command, timer.next() - before)
                bar.update(world.time - before)
                ending = referee.touched(world)
        bar.refresh()
    outcome, reason = ending
    if outcome == "contact":
        recorder.contact(command, reason)
    episode = recorder.episode(outcome, reason, config, seed)
    return episode if tracer is None else replace(episode, trace=tracer.trace())


def _bar(scenario: Scenario, progress: bool) -> Any:
    """A bar on stderr, in simulated seconds; it shows nothing unless ``progress`` is set."""
    return progress_bar(
        total=scenario.time_limit,
        desc=scenario.name,
        unit="s",
        disable=not progress,
        delay=1e-6,  # nothing is shown of a mission that cannot begin
        bar_format="{desc}: {n:.1f} of at most {total:.0f} simulated s [{elapsed}]",
    )


def _check_start(scenario: Scenario) -> None:
    """Raises OutOfMap or StartOccupied for a start off the map or in a wall."""
    x, y, _ = scenario.start
    radius = scenario.robot.footprint.inscribed
    if words := misfit(scenario.grid, "the start", (x, y), radius, scenario.unknown):
        raise StartOccupied(words)


def _explained(status: Any, scenario: Scenario) -> Any:
    """The first tick's status, with what is wrong with start, goal or map; raises an InputError.

    Where the footprint fits at the start and only the margin does not, the mission is blocked.
    """
    from dynastar.navigator import Status

    x, y, _ = scenario.start
    goal = scenario.goals[0]
    radius = scenario.robot.footprint.inscribed
    error = explained(
        status.error, scenario.grid, (x, y), (goal.x, goal.y), radius, scenario.unknown
    )
    if isinstance(error, StartOccupied):
        _check_start(scenario)
    elif isinstance(error, InputError):
        raise error
    return replace(status, reason=str(error)) if isinstance(status, Status) else status


def effective_config(scenario: Scenario) -> Any:
    """The NavigatorConfig of a mission: the preset, the scenario's fields, its own overrides.

    The declared error bounds are at least those of the scenario's noise, and of the rounding of
    ranges. Raises ConfigError.
    """
    from dynastar.navigator import configured

    noise = scenario.noise
    overrides: Mapping[str, Any] = {
        "latency": scenario.latency,
        "goal_tolerance": scenario.goal_tolerance,
        "heading_tolerance": scenario.heading_tolerance,
        "unknown": scenario.unknown,
        **scenario.navigator,
    }
    config = configured(scenario.preset, overrides)
    bounds = {
        "range_error": max(config.range_error, noise.range_bound + 0.5 * scenario.lidar.rounding),
        "pose_error": max(config.pose_error, math.hypot(noise.pose_bound, noise.pose_bound)),
        "heading_error": max(config.heading_error, noise.heading_bound),
    }
    return configured(scenario.preset, {**overrides, **bounds})


class Referee:
    """Decides when a mission is over, and what it came to, by the truth."""

    def __init__(self, scenario: Scenario, config: Any) -> None:
        self._goals, self._limit = list(scenario.goals), scenario.time_limit
        noise, bound = scenario.noise, scenario.noise.pose_bound
        self._tolerance = config.goal_tolerance + math.hypot(bound, bound) + 1e-6
        self._turn_tolerance = config.heading_tolerance + noise.heading_bound + 1e-6
        self._grace = GRACE + scenario.latency
        self._limits = scenario.robot.limits
        self._final = ""
        self._until = math.inf
        self._was_there = False  # within the tolerances of the last goal, since the last word
        self._lost_since: float | None = None

    def touched(self, world: World) -> tuple[str, str] | None:
        """("contact", reason) once the robot has touched something."""
        if not world.contact:
            return None
        how = "while moving" if world.contact == "moving" else "while standing still"
        x, y, _ = world.pose
        return "contact", f"contact {how} at ({x:.2f}, {y:.2f}), {world.time:.2f} s"

    def ended(self, world: World, status: Any) -> tuple[str, str] | None:
        """(outcome, reason) once the mission is over, seen after each command."""
        if world.contact:
            return self.touched(world)
        if len(self._goals) > 1 and self._gap(world) <= self._tolerance:
            self._goals.pop(0)
        state, reason = str(status.state), str(status.reason)
        if state in ("arrived", "blocked"):
            return self._last_word(world, state, reason)
        if state != "sensor_lost":
            self._lost_since = None
        elif self._lost_since is None:
            self._lost_since = world.time
        elif world.time - self._lost_since > SENSOR_LOST and world.resting:
            return "sensor_lost", reason
        if world.time >= self._limit - 1e-9:
            return "timeout", f"not there after {self._limit:g} s; {state}: {reason}"
        return None

    def _last_word(self, world: World, state: str, reason: str) -> tuple[str, str] | None:
        """The navigator has finished: the robot is let come to rest, and the word is checked."""
        if state != self._final:
            self._final, self._was_there = state, False
            self._until = world.time + self._grace + stopping_time(world.twist, self._limits)
        gap, off = self._gap(world), self._off(world)
        is_last = len(self._goals) == 1
        is_there = is_last and gap <= self._tolerance and off <= self._turn_tolerance
        self._was_there = self._was_there or is_there
        if not world.resting:
            if world.time < self._until:
                return None
            return "timeout", f"said '{state}' and did not come to rest in {self._grace:g} s more"
        if state == "arrived" and not self._was_there:
            which = "the goal" if is_last else "a goal before the last"
            turned = f" and {off:.2f} rad" if is_last and off > self._turn_tolerance else ""
            return "blocked", f"said 'arrived' {gap:.2f} m{turned} away from {which}"
        return state, reason

    def _gap(self, world: World) -> float:
        """Metres from the true place to the next goal."""
        return math.dist(self._goals[0][:2], world.pose[:2])

    def _off(self, world: World) -> float:
        """The angle (rad) that is left to the heading of the next goal; 0 if it has none."""
        heading = self._goals[0].heading
        return 0.0 if heading is None else abs(wrap_angle(heading - world.pose.theta))
