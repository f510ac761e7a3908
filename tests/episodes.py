"""An episode of a few ticks, made and not driven."""

import math

import numpy as np

from dynastar.episode import Episode, EventRecord, PlanRecord
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.path import Trajectory


def episode(ticks: int = 5, movers: int = 2, plans: int = 2, masks: bool = True) -> Episode:
    rng = np.random.default_rng(ticks)
    shape = (4, 6)
    return Episode(
        grid=OccupancyGrid(
            rng.integers(-1, 101, shape, dtype=np.int8),
            GridFrame(0.05, -1.0, 1e-5, 0.3),
            keepout=rng.random(shape) < 0.5 if masks else None,
            speed_limit=np.full(shape, np.inf, np.float32) if masks else None,
        ),
        robot="jackal",
        radius=0.3327,
        footprint=rng.random((4, 2)),
        goals=np.array([[1.0, 2.0, math.nan], [3.0, 4.0, 0.1]]),
        goal_tolerance=0.25,
        trajectory=Trajectory(
            np.arange(ticks) * 0.1, rng.random((ticks, 3)), rng.random((ticks, 2))
        ),
        commands=rng.random((ticks, 2)),
        clearance=np.full(ticks, np.inf),
        command_ms=rng.random(ticks),
        states=np.array(["driving", "arrived", "wärten"] * ticks, dtype=np.str_)[:ticks],
        movers=rng.random((ticks, movers, 2)),
        mover_radii=rng.random(movers),
        obstacles=tuple(rng.random((k, 2)) for k in (3, 24)[:plans]),
        plans=tuple(
            PlanRecord(0.1 * k, "blocked", rng.random((k + 1, 2)), np.full((k, 2), k, np.int32))
            for k in range(plans)
        ),
        events=(EventRecord(0.2, "contact", "with a 'mover'\n"),)[:plans],
        outcome="arrived",
        reason="within 0.25 m",
        contact="",
        explored_frame=(0.1, 0.0, -2.0, 0.0),
        config={"dwa": {"horizon": 3.0, "none": None}, "limit": math.inf},
        scenario={"map": "a.yaml", "start": [1, 2.5]},
    )
