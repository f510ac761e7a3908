"""A scene that is driven live: the navigator in a world that is changed, and the record of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

from dynastar import io
from dynastar.config import choose
from dynastar.episode import Episode
from dynastar.errors import InputError
from dynastar.geometry import Goal, Twist
from dynastar.navigator import Navigator
from dynastar.navigator.config import PRESETS
from dynastar.path import Trajectory
from dynastar.play import messages as ask
from dynastar.play.journal import Journal, frame_data, scene_data
from dynastar.play.scenery import Scenery
from dynastar.play.settings import sliders, value_of, with_setting
from dynastar.simulation import Scenario
from dynastar.simulation.loop_timer import LoopTimer
from dynastar.simulation.record import Recorder, goal_table
from dynastar.simulation.run import effective_config
from dynastar.simulation.start import check_start
from dynastar.simulation.tracing import Tracer, considered

PERIOD = 0.05  # s
RECORDED = 600.0  # s that a recording holds at most; then the next begins


class Session:
    """Drives a scenario period by period, and carries out what messages ask for.

    ``journal`` is what has to be told of it, ``paused`` whether time stands still, ``lasted`` the
    length of the last tick (s). ``scenes`` are scenario files by name. A scene begins paused, and its
    first goal starts it. Everything is called from one thread.
    """

    def __init__(self, scenario: Scenario, scenes: Mapping[str, Path]) -> None:
        self.scenes = scenes
        self._carry_out: Mapping[type, Callable[[Any], None]] = {
            ask.Goals: self._go,
            ask.Stroke: self._stroke,
            ask.Walker: lambda message: self.scenery.put_in(message),
            ask.Push: lambda message: self.scenery.push(message),
            ask.Setting: self._set,
            ask.Choose: self._choose,
            ask.Pause: self._pause,
            ask.Step: self._step,
            ask.Reset: lambda message: self._begin(self._scenario),
            ask.Load: self._load,
        }
        self._open(scenario)

    def take(self, message: ask.Message) -> None:
        """Carries out a message. InputError, with the reason, changes nothing."""
        self._carry_out[type(message)](message)
        if self.paused:
            self._show()

    # -- the scene --------------------------------------------------------------------------------

    def _open(self, scenario: Scenario) -> None:
        scenario = replace(scenario, navigator={**scenario.navigator, "period": PERIOD})
        self._made = scenario
        self._begin(scenario)

    def _begin(self, scenario: Scenario) -> None:
        """Begins a scene; ``_scenario`` is it as it was made, with what has been set since."""
        config = effective_config(scenario)
        check_start(scenario)
        self._scenario, self.scenery, self.paused = scenario, Scenery(scenario), True
        self._timer, self.lasted = LoopTimer(scenario.loop, PERIOD, scenario.seed), PERIOD
        self.touched, self.halted = {"moving": 0, "resting": 0}, ""
        self._drive(config, scenario.goals)

    def _drive(self, config: Any, goals: tuple[Goal, ...]) -> None:
        """Drives to goals with another navigator, and begins another recording."""
        scenario = self.scenery.scenario
        self.navigator = Navigator(scenario.grid, scenario.robot, config)
        self._aim(goals)
        self._record()

    def _aim(self, goals: Sequence[Goal]) -> None:
        self.navigator.set_goal(goals)
        self._goals = tuple(goals)

    def _record(self) -> None:
        self._since, self._ticks = self.scenery.world.time, 0
        self._recorder = Recorder(self.scenery.scenario, self.scenery.world, self.navigator)
        self._tracer = Tracer(self)
        self.journal = Journal(
            {
                **scene_data(self.scenery.scenario, self.navigator.planning_map.grid.frame),
                "scenes": list(self.scenes),
                "presets": list(PRESETS),
                **self._settings(),
            }
        )
        self._last = Twist(0.0, 0.0), 0.0, considered(self.navigator.status)
        self._show()

    def _settings(self) -> dict[str, Any]:
        """The settings as the page takes them."""
        scenario, config = self._scenario, self.navigator.config
        return {
            "preset": scenario.preset,
            "sliders": [
                {"name": name, "value": value_of(scenario.robot, config, name), **slider._asdict()}
                for name, slider in sliders(self._made.robot).items()
            ],
        }

    # -- the loop ---------------------------------------------------------------------------------

    def tick(self) -> None:
        """Lets a period pass, unless the robot is halted, and tells of it."""
        if self.halted:
            return
        world, navigator = self.scenery.world, self.navigator
        state, scan = world.sensed_state(), world.scan()
        began = perf_counter()
        command = navigator.command(state, scan)
        command_ms = 1e3 * (perf_counter() - began)
        status = navigator.status
        self._recorder.tick(command, command_ms, status)
        self._ticks += 1
        thought, cells = self._tracer.tick(status)
        if len(cells):
            self.journal.say("seen", cells=cells)
        self._last = command, command_ms, thought
        self._show()
        self.lasted = self._timer.next() - world.time
        world.step(command, self.lasted)
        if world.contact:
            self._touch(world.contact)
        if world.time - self._since > RECORDED:
            self._record()

    def _show(self) -> None:
        """Show the world as it is now, with the last command and what was considered for it."""
        command, command_ms, thought = self._last
        status, goals = self.navigator.status, tuple(self.navigator.mission.goals)
        self.journal.read(self._recorder)
        self.journal.show(
            {
                **frame_data(self.scenery.world, goals, status, thought),
                "command": list(command),
                "commandMs": round(command_ms, 2),
                "touched": self.touched,
            }
        )

    def _touch(self, how: str) -> None:
        """Counts a contact, which only one with walkers does not end."""
        self.touched[how] += 1
        words = "while moving" if how == "moving" else "while standing still"
        self._recorder.event("contact", f"contact {words}")
        if not self.scenery.part():
            self.halted = f"contact with an obstacle {words}: reset the scene"
            self._recorder.event("halt", self.halted)
            self.journal.read(self._recorder)

    # -- what is asked for ------------------------------------------------------------------------

    def _go(self, message: ask.Goals) -> None:
        grid, goals = self.scenery.scenario.grid, [Goal(*goal) for goal in message.goals]
        for goal in goals:
            if grid.occupied[grid.world_to_cell(goal.x, goal.y)]:
                raise InputError(f"({goal.x:.2f}, {goal.y:.2f}) is in a wall of the map")
        if message.more:
            goals = [*self.navigator.mission.goals, *goals]
        if len(goals) > ask.MOST_GOALS:
            raise InputError(f"{len(goals)} goals: at most {ask.MOST_GOALS} are taken")
        self._aim(goals)
        if goals and self.scenery.world.time == 0.0:
            self.paused = False

    def _stroke(self, message: ask.Stroke) -> None:
        self.scenery.stroke(message)
        self.journal.obstacles(self.scenery.scenario.obstacles)

    def _set(self, message: ask.Setting) -> None:
        name, value = message
        self._use(with_setting(self._scenario, self._made.robot, name, value))

    def _choose(self, message: ask.Choose) -> None:
        made = self._made
        self._use(replace(self._scenario, preset=message.preset, navigator=made.navigator))

    def _use(self, scenario: Scenario) -> None:
        """Drives on with other settings."""
        config, before = effective_config(scenario), self._scenario
        self._scenario, goals = scenario, tuple(self.navigator.mission.goals)
        now = self.scenery.scenario
        self.scenery.use(
            replace(now, preset=scenario.preset, navigator=scenario.navigator, robot=scenario.robot)
        )
        if scenario.preset == before.preset and scenario.robot is before.robot:
            self.navigator.retune(config.dwa)
            self.journal.say("settings", **self._settings())
        else:
            self._drive(config, goals)

    def _pause(self, message: ask.Pause) -> None:
        self.paused = message.paused

    def _step(self, message: ask.Step) -> None:
        del message
        if not self.paused:
            raise InputError("a step is for when time stands still: pause first")
        self.tick()

    def _load(self, message: ask.Load) -> None:
        self._open(io.load_scenario(choose(message.scene, self.scenes, "scene")))

    # -- what is kept -----------------------------------------------------------------------------

    def as_scenario(self) -> Scenario:
        """The scene to begin where it stands, for the goals that are left, or those that it had."""
        goals = tuple(self.navigator.mission.goals) or self._made.goals
        return replace(self.scenery.as_of_now(), goals=goals)

    def as_episode(self) -> Episode:
        """What was driven since the recording began; InputError if nothing was."""
        if not self._ticks:
            raise InputError("nothing has been driven yet")
        mission, seed = self.navigator.mission, self._scenario.seed
        episode = self._recorder.episode(mission.state, mission.reason, self.navigator.config, seed)
        goals, trace = goal_table(self._goals), self._tracer.trace()
        return replace(_from_zero(episode, self._since), goals=goals, trace=trace)


def _from_zero(episode: Episode, since: float) -> Episode:
    """An episode whose times (s) count from ``since``."""
    driven = episode.trajectory
    plans = tuple(plan._replace(stamp=plan.stamp - since) for plan in episode.plans)
    events = tuple(event._replace(stamp=event.stamp - since) for event in episode.events)
    trajectory = Trajectory(driven.times - since, driven.poses, driven.twists)
    return replace(episode, trajectory=trajectory, plans=plans, events=events)
