"""A suite of two short missions in a room, for tests of the frame."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from driving import ROUND, room
from dynastar.bench import driven
from dynastar.bench.missions import Mission
from dynastar.geometry import Goal
from dynastar.simulation import Scenario

BOX = np.array([[3.4, 2.6], [4.0, 2.6], [4.0, 3.2], [3.4, 3.2]])


def scenario(mission: Mission, options: Any, repeat: int) -> Scenario:
    """Mission 3 crosses the room round an unmapped box; mission 5 has no time to."""
    made = Scenario(
        name=f"small {mission.number}",
        grid=room(),
        robot=ROUND,
        start=(1.5, 3.0, 0.0),
        goals=(Goal(6.0, 3.0),),
        obstacles=(BOX,),
        time_limit=1.0 if mission.number == 5 else 60.0,
    )
    return driven.realistic(made, options)


def run_mission(mission: Mission, options: Any, repeat: int) -> dict[str, Any]:
    return driven.run_mission(
        scenario(mission, options, repeat),
        options,
        mission,
        repeat,
        score=lambda episode: 1.0 if episode.outcome == "arrived" else 0.0,
        group=f"group {mission.number}",
        extra=lambda episode: {"ticks": len(episode.commands), "odd": math.pi},
    )


SUITE = SimpleNamespace(
    DEFAULT_MISSIONS=None,
    QUICK_MISSIONS=1,
    PUBLISHED=(("someone", "all of them", "Key2020"),),
    COMPARABLE="nothing",
    missions=lambda options: [Mission(3), Mission(4), Mission(5)],
    leave_out=lambda mission, options: "by rule" if mission.number == 4 else "",
    scenario=scenario,
    run_mission=run_mission,
)
