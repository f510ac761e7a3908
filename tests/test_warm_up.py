"""Nothing is compiled, nor read from the cache, after the warm-up."""

import subprocess
import sys

import pytest

from dynastar.dwa.search import search
from dynastar.guidance.marching import march
from dynastar.simulation import warm_up

# Compilations and loads from the cache while driving, for a few seconds; argv: data folder or "", suites.
COUNT = """
import sys
from dataclasses import replace
from pathlib import Path
import dynastar.compiled
from numba.core import caching, event
from dynastar.bench.missions import Options
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import load_suite
from dynastar.dwa.nearest import nearest_admissible
from dynastar.dwa.pose_search import search_poses
from dynastar.simulation import warm_up
from dynastar.simulation.run import drive

compiled, loaded, driving = [], [], False

class Compiled(event.Listener):
    def on_start(self, event):
        if driving:  # worlds may be made by kernels that no robot needs
            compiled.append(event.data["dispatcher"].py_func.__qualname__)
    def on_end(self, event):
        pass

load = caching.Cache.load_overload
def load_overload(cache, *arguments):
    if driving:
        loaded.append(cache._py_func.__qualname__)
    return load(cache, *arguments)

event.register("numba:compile", Compiled())
caching.Cache.load_overload = load_overload
warm_up()
compiled += [k.__name__ for k in (search_poses, nearest_admissible) if not k.signatures]  # rare
options = Options(data=Path(sys.argv[1]) if sys.argv[1] else None, missions=2)
for name in sys.argv[2:]:
    suite = load_suite(name)
    for mission in choose_missions(suite, options)[0][:2]:
        scenario = suite.scenario(mission, options, 0)
        drive(replace(scenario, time_limit=0.1))  # the simulator's own
        driving = True
        drive(replace(scenario, time_limit=4.0))
        driving = False
print(compiled, loaded)
"""


def counted(*arguments):
    return subprocess.run(
        [sys.executable, "-c", COUNT, *arguments], capture_output=True, text=True, check=True
    ).stdout.strip()


def test_driving_compiles_nothing_and_loads_nothing():
    assert counted("", "office", "paper", "random", "people") == "[] []"


@pytest.mark.data
def test_nor_do_the_public_suites(data_dir):
    assert counted(str(data_dir), "barn", "dynabarn", "mrpb", "crowd", "maps") == "[] []"


def test_the_choice_without_a_scan_is_of_the_kinds_that_a_drive_has():
    """Else the dynamic window would be compiled once for it, and once more for a drive."""
    warm_up()
    assert len(search.signatures) == len(march.signatures) == 1
