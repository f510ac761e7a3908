from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dynastar.episode import Episode, EventRecord, PlanRecord
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.path import Trajectory

RESOLUTION = 0.05
WALLS = [  # x0, y0, x1, y1 in metres
    *[(0, 0, 40, 0.2), (0, 24.8, 40, 25), (0, 0, 0.2, 25), (39.8, 0, 40, 25)],
    *[(0, 10, 6, 10.15), (7.2, 10, 16, 10.15), (17.2, 10, 30, 10.15), (31.2, 10, 40, 10.15)],
    *[(0, 13, 10, 13.15), (11.2, 13, 22, 13.15), (23.2, 13, 34, 13.15), (35.2, 13, 40, 13.15)],
    *[(12, 0, 12.15, 10), (24, 0, 24.15, 10), (15, 13, 15.15, 25), (28, 13, 28.15, 25)],
    *[(2, 2, 3.6, 2.8), (2, 5, 3.6, 5.8), (8, 3, 9.6, 3.8), (15, 4, 18, 5), (30, 18, 33, 19.2)],
    *[(4, 18, 7, 19), (19, 17, 20.6, 17.8), (19, 20, 20.6, 20.8), (36, 3, 37, 6)],
]
CORNERS = [(2.0, 8.0), (6.6, 8.6), (7.4, 11.5), (22.0, 11.3), (22.6, 14.0), (25.0, 21.5)]
SECOND = [(12.0, 11.5), (14.5, 12.3), (21.5, 11.8), (22.6, 14.0), (25.0, 21.5)]


def office_grid() -> OccupancyGrid:
    rows, columns = round(25 / RESOLUTION), round(40 / RESOLUTION)
    values = np.zeros((rows + 40, columns + 40), dtype=np.int8)
    values[:] = -1
    values[20:-20, 20:-20] = 0
    for x0, y0, x1, y1 in WALLS:
        low, high = round(y0 / RESOLUTION) + 20, round(y1 / RESOLUTION) + 20
        values[low:high, round(x0 / RESOLUTION) + 20 : round(x1 / RESOLUTION) + 20] = 100
    return OccupancyGrid(values, GridFrame(RESOLUTION, -1.0, -1.0))


def smooth(corners: list[tuple[float, float]], count: int) -> np.ndarray:
    points = np.array(corners, dtype=float)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    at = np.linspace(0.0, arc[-1], count)
    line = np.column_stack([np.interp(at, arc, points[:, i]) for i in (0, 1)])
    kernel = np.hanning(23) / np.hanning(23).sum()
    padded = np.pad(line, ((11, 11), (0, 0)), mode="edge")
    return np.column_stack([np.convolve(padded[:, i], kernel, "valid") for i in (0, 1)])


def box(x: float, y: float, length: float, width: float) -> np.ndarray:
    return np.array([(x, y), (x + length, y), (x + length, y + width), (x, y + width)])


def walker(times: np.ndarray, a: tuple[float, float], b: tuple[float, float]) -> np.ndarray:
    share = np.abs((0.7 * times / np.hypot(b[0] - a[0], b[1] - a[1])) % 2.0 - 1.0)
    return np.array(a) + share[:, None] * (np.array(b) - np.array(a))


def make_episode(ticks: int = 700, outcome: str = "arrived", contact: str = "") -> Episode:
    times = 0.1 * np.arange(ticks)
    driven = [*CORNERS[:3], (11.0, 11.2), (13.0, 12.2), (16.0, 12.3), *CORNERS[3:]]
    positions = smooth(driven, ticks)
    steps = np.gradient(positions, times, axis=0)
    heading = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    pace = np.clip(np.minimum(times, times[-1] - times) / 3.0, 0, 1) * (0.8 + 0.2 * np.sin(times))
    speed = np.hypot(*steps.T) * pace
    twists = np.column_stack([speed, np.gradient(heading, times)])
    walks = [
        walker(times, (9, 10.8), (30, 11.0)),
        walker(times, (33, 12.2), (3, 12.4)),
        walker(times, (17, 15), (21, 23.5)),
        walker(times, (24.0, 16), (27, 24)),
    ]
    rows, columns = np.mgrid[150:300, 40:520]
    disc = np.hypot(rows - 220, (columns - 280) * 0.35) < 75
    grid = office_grid()
    disc &= grid.values[150:300, 40:520] == 0
    explored = np.column_stack([rows[disc], columns[disc]]).astype(np.int32)
    plans = (
        PlanRecord(0.0, "first plan", np.array(CORNERS), explored),
        PlanRecord(23.0, "the path is blocked", np.array(SECOND), explored[:0]),
        PlanRecord(45.0, "led away", np.array([(21.5, 12.0), *SECOND[3:]]), explored[:0]),
    )
    return Episode(
        grid=grid,
        robot="pioneer3dx",
        radius=0.25,
        footprint=np.empty((0, 2)),
        goals=np.array([[25.0, 21.5]]),
        goal_tolerance=0.25,
        trajectory=Trajectory(times, np.column_stack([positions, heading]), twists),
        commands=twists,
        clearance=0.4 + 0.2 * np.cos(times),
        command_ms=3.0 + np.sin(times),
        states=np.array(["following"] * (ticks - 1) + [outcome]),
        movers=np.stack(walks, axis=1),
        mover_radii=np.array([0.3, 0.3, 0.25, 0.25]),
        obstacles=(
            *(box(12.6, 10.2, 0.9, 1.2), box(18.0, 11.6, 0.6, 0.6), box(5.0, 6.5, 0.8, 0.5)),
            *(box(23.6, 17.0, 0.7, 0.7), box(30.0, 14.5, 1.2, 0.8), box(26.0, 3.0, 0.8, 0.8)),
        ),
        plans=plans,
        events=(EventRecord(30.0, "recovery", "turned to look"),),
        outcome=outcome,
        reason="at the goal" if outcome == "arrived" else "touched a box at (25.0, 21.5)",
        contact=contact,
        explored_frame=(0.05, -1.0, -1.0, 0.0),
        scenario={"name": "office"},
    )


@pytest.fixture(scope="session")
def office() -> Episode:
    return make_episode()


@pytest.fixture(scope="session")
def cut(office: Episode) -> Callable[[int], Episode]:
    """The office mission's first so many ticks."""

    def first(ticks: int) -> Episode:
        driven = office.trajectory
        return replace(
            office,
            trajectory=Trajectory(
                driven.times[:ticks], driven.poses[:ticks], driven.twists[:ticks]
            ),
            commands=office.commands[:ticks],
            clearance=office.clearance[:ticks],
            command_ms=office.command_ms[:ticks],
            states=office.states[:ticks],
            movers=office.movers[:ticks],
        )

    return first
