"""``dynastar bench`` with one more suite, ``interrupted``, whose mission 1 presses Ctrl-C.

It does so as soon as mission 0 is written and mission 2 is under way, so that both processes are busy.
A file ``again`` in the suite's folder lets all missions come to an end.
"""

import os
import signal
import sys
import time

from dynastar.bench.missions import Mission
from dynastar.bench.suites import SUITES
from dynastar.cli import main

SUITES["interrupted"] = "interrupted_bench"

DEFAULT_MISSIONS = None


def missions(options):
    return map(Mission, range(4))


def leave_out(mission, options):
    return ""


def run_mission(mission, options, repeat):
    if mission.number > 0 and not (options.data / "again").exists():
        if mission.number == 2:
            (options.data / "under way").touch()
        while mission.number > 1 or not ready(options.data):
            time.sleep(0.01)
        os.killpg(0, signal.SIGINT)
        signal.pause()
    return {"outcome": "arrived", "process": os.getpid()}


def ready(folder):
    rows = (folder / "result.json.rows.jsonl").read_bytes().count(b"\n") - 1
    return rows == 1 and (folder / "under way").exists()


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)  # it may have been started ignoring it
    sys.exit(main())
