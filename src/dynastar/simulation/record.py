"""Writing down a run as it happens."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.episode import Episode, EventRecord, PlanRecord
from dynastar.geometry import Goal, Twist
from dynastar.path import Trajectory
from dynastar.simulation.imperfections import PERFECT
from dynastar.simulation.scenario import Scenario
from dynastar.simulation.world import World

Floats = npt.NDArray[np.float64]

NOTHING_EXPLORED = np.empty((0, 2), dtype=np.int32)


class Recorder:
    """Gathers what an Episode holds, tick by tick; ``plans`` and ``events`` so far may be read."""

    def __init__(self, scenario: Scenario, world: World, controller: Any) -> None:
        self._scenario, self._world, self._controller = scenario, world, controller
        self._rows: list[tuple[float, ...]] = []
        self._states: list[str] = []
        self._limits: list[str] = []
        self._movers: list[Floats] = []
        self.plans: list[PlanRecord] = []
        self.events: list[EventRecord] = []
        self._plan_id: int | None = None
        self._recoveries = self._bumps = self._stops = 0
        self._frame = scenario.grid.frame

    def tick(self, command: Twist, command_ms: float, status: Any) -> None:
        """One call of ``command``: its answer, the time it took, and the status after it."""
        state = str(status.state)
        if not self._states or state != self._states[-1]:
            self.event("state", f"{state}: {status.reason}" if status.reason else state)
        for _ in range(status.recoveries - self._recoveries):
            self.event("recovery", str(status.reason))
        self._recoveries = status.recoveries
        if status.plan is not None and status.plan_id != self._plan_id:
            self._plan_id, self._frame = status.plan_id, status.planning_frame
            explored = getattr(self._controller, "explored", NOTHING_EXPLORED)
            self.plans.append(
                PlanRecord(
                    self._world.time,
                    str(status.plan_reason),
                    np.array(status.plan.path.points, dtype=np.float64),
                    np.array(explored, np.int32),
                )
            )
        self._row(command, command_ms, state, str(getattr(status, "limited_by", None) or ""))

    def contact(self, command: Twist, detail: str) -> None:
        """The moment of a contact; after the first tick, no call of ``command`` belongs to it."""
        self.event("contact", detail)
        if self._world.time > self._rows[-1][0]:
            self._row(command, math.nan, self._states[-1], self._limits[-1])

    def event(self, kind: str, detail: str) -> None:
        """Something that happened now."""
        self.events.append(EventRecord(self._world.time, kind, detail))

    def _row(self, command: Twist, command_ms: float, state: str, limit: str) -> None:
        world = self._world
        if world.late is not None:
            for _ in range(world.late.stops - self._stops):
                self.event("stop", "a walker stopped for the robot")
            for _ in range(world.late.bumps - self._bumps):
                self.event("bump", "a walker touched the robot, which did not move towards it")
            self._stops, self._bumps = world.late.stops, world.late.bumps
        self._rows.append(
            (world.time, *world.pose, *world.twist, *command, world.clearance, command_ms)
        )
        self._states.append(state)
        self._limits.append(limit)
        self._movers.append(world.movers)

    def episode(self, outcome: str, reason: str, config: Any, seed: int) -> Episode:
        """All of it; ``config`` is the effective one, a NamedTuple."""
        scenario, table = self._scenario, np.array(self._rows, dtype=np.float64).reshape(-1, 10)
        footprint = scenario.robot.footprint
        frame = self._frame
        return Episode(
            grid=scenario.grid,
            robot=scenario.robot.name,
            radius=footprint.circumscribed,
            footprint=footprint.vertices,
            goals=goal_table(scenario.goals),
            goal_tolerance=float(config.goal_tolerance),
            trajectory=Trajectory(table[:, 0], table[:, 1:4], table[:, 4:6]),
            commands=table[:, 6:8],
            clearance=table[:, 8],
            command_ms=table[:, 9],
            states=np.array(self._states, dtype=np.str_),
            movers=_padded(self._movers, len(self._world.mover_radii)),
            mover_radii=np.array(self._world.mover_radii),
            obstacles=self._world.obstacles,
            plans=tuple(self.plans),
            events=tuple(self.events),
            outcome=outcome,
            reason=reason,
            contact=self._world.contact,
            explored_frame=(frame.resolution, frame.x, frame.y, frame.yaw),
            limits=np.array(self._limits, dtype=np.str_),
            config=plain(config),
            scenario=described(scenario, seed),
        )


def goal_table(goals: Sequence[Goal]) -> Floats:
    """Goals as an Episode has them, (k, 3): x, y and heading, NaN for any."""
    rows = [(g.x, g.y, math.nan if g.heading is None else g.heading) for g in goals]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _padded(movers: list[Floats], count: int) -> Floats:
    """Positions (n, count, 2) of ticks (m, 2) each; NaN for movers who came later."""
    padded = np.full((len(movers), count, 2), np.nan)
    for row, places in zip(padded, movers, strict=True):
        row[: len(places)] = places
    return padded


def plain(value: Any) -> Any:
    """Nested NamedTuples, mappings, sequences and arrays as dicts, lists and plain numbers."""
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def described(scenario: Scenario, seed: int) -> dict[str, Any]:
    """The scenario as plain data, maps and polygons aside, with the seed it was run with.

    Movers' keys are left out where ``source`` says what the scenario was read from.
    """
    names = ("name", "start", "goals", "noise", "latency", "goal_tolerance", "heading_tolerance")
    more = ("time_limit", "unknown", "preset", "navigator", "source", "attention", "legs")
    movers = () if scenario.source else tuple(vars(mover) for mover in scenario.movers)
    imperfect = [name for name in PERFECT if getattr(scenario, name) != PERFECT[name]]
    data = {name: plain(getattr(scenario, name)) for name in (*names, *more, *imperfect)}
    faults = [fault.described() for fault in scenario.faults]
    more_data = {"robot": scenario.robot.name, "seed": seed, "movers": plain(movers)}
    if scenario.crowd:
        more_data["crowd"] = [plain(vars(pedestrian)) for pedestrian in scenario.crowd]
    return data | more_data | ({"faults": faults} if faults else {})
