"""Runs the missions of `dynastar bench all --quick`, but of a report seed: for published tables only.

The other controllers drive half of them, there one of six, drawn at random.

python benchmarks/scoreboard.py --seed 10000 --json-out all.json
"""

import argparse
import os
from pathlib import Path

from dynastar import io
from dynastar.bench.missions import Options
from dynastar.bench.scoreboard import QUICK_COMPETITORS, run_all
from dynastar.cli.compiling import prepare

EVERY = 2  # of the missions, the other controllers drive one in so many

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--json-out", type=Path, required=True, metavar="FILE")
    parser.add_argument("--missions", type=int, metavar="N", help="so many of each suite: a trial")
    arguments = parser.parse_args()
    prepare()
    keep = arguments.json_out.with_name(f"{arguments.json_out.name}.rows.jsonl")
    options = Options(
        seed=arguments.seed,
        missions=arguments.missions,
        quick=arguments.missions is None,
        workers=os.cpu_count() or 1,
    )
    result = run_all(options, progress=True, keep=keep, others=QUICK_COMPETITORS, every=EVERY)
    io.write_json(arguments.json_out, result)
    keep.unlink()
