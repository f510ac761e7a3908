"""``dynastar tune`` with one more suite, ``tuned``, whose missions take no time.

It stays in a mission for ever, once 21 are driven, until a file ``again`` is in the suite's folder.
"""

import signal
import sys
from itertools import count

from dynastar.bench.missions import Mission
from dynastar.bench.suites import SUITES
from dynastar.cli import main

DEFAULT_MISSIONS = None
driven = count(1)


def missions(options):
    return map(Mission, count())


def leave_out(mission, options):
    return "" if mission.number % 3 else "by rule"


def scenario(mission, options, repeat):
    raise NotImplementedError


def run_mission(mission, options, repeat):
    if next(driven) > 21 and not (options.data / "again").exists():
        (options.data / "under way").touch()
        signal.pause()
    horizon = options.settings["dwa"]["horizon"]
    time = 10.0 + mission.number + options.seed % 7 - horizon
    return {"outcome": "arrived", "time": time, "length": 3.0, "smoothness": 1.0}


if __name__ == "__main__":
    SUITES["tuned"] = "tuned_bench"
    sys.exit(main())
