"""Suite office: the demo's office, once for each seed; mission number = seed.

The seed sets the errors of the senses and where on their walks the people are at first. Map, boxes,
errors, latency and period are those of ``examples/office/office.toml``; ``--ideal`` leaves out errors
and latency.
"""

import os
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options
from dynastar.errors import DataError
from dynastar.io.scenario_file import load_scenario
from dynastar.paths import local_path
from dynastar.simulation import Mover, Noise, Scenario

DEFAULT_MISSIONS = 10
QUICK_MISSIONS = 8

FILE = Path("office") / "office.toml"
EXAMPLES = Path(__file__).parents[4] / "examples"  # of a clone


def missions(options: Options) -> Iterator[Mission]:
    """One mission for every seed, without end."""
    del options
    return (Mission(number) for number in count())


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves nothing out."""
    del mission, options
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The office with its people somewhere else on their walks."""
    del repeat
    made = load_scenario(office_file(options))
    random = np.random.default_rng([options.seed, mission.number])
    if options.ideal:
        made = replace(made, noise=Noise(), latency=0.0)
    return replace(
        made,
        name=f"office {mission.number}",
        movers=tuple(_moved_on(mover, float(random.uniform())) for mover in made.movers),
        seed=mission.number,
        source={},  # the file does not have these movers
    )


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives the office with one seed."""
    return driven.run_mission(
        scenario(mission, options, repeat), options, mission, repeat, group="office"
    )


def office_file(options: Options) -> Path:
    """The office's scenario file, in --data or $DYNASTAR_DATA, else in the clone; else DataError."""
    named = options.data or os.environ.get("DYNASTAR_DATA")
    places = [EXAMPLES / FILE, Path("examples") / FILE]
    if named:
        given = local_path(named, DataError)
        places = [given / FILE.name, given / FILE, *places]
    for place in places:
        if place.is_file():
            return place
    raise DataError(
        f"the suite office reads {FILE.name}: run in a clone, or give the folder of it as --data DIR"
    )


def _moved_on(mover: Mover, fraction: float) -> Mover:
    """The mover a fraction of its round later."""
    span = float(mover.times[-1] - mover.times[0])
    rounds = 2.0 if mover.after == "back_and_forth" else 1.0
    return replace(mover, times=np.asarray(mover.times) - fraction * rounds * span)
