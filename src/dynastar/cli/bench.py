"""``dynastar bench``: a suite of missions, every failure counted."""

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from dynastar.bench import SUITES, Options, load_suite, run_suite
from dynastar.cli.show import as_json, as_table
from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.io.files import write_json

SHOWN_FAILURES = 20


def execute(arguments: argparse.Namespace) -> int:
    """Runs the suite; prints its totals and the missions that failed, or JSON."""
    choose(arguments.suite, SUITES, "suite")
    to_file = arguments.json_out not in (None, "-")
    if to_file and not Path(arguments.json_out).absolute().parent.is_dir():
        raise InputError(f"--json-out {arguments.json_out}: its folder is not there; make it first")
    options = Options(
        data=arguments.data,
        missions=arguments.missions,
        repeat=arguments.repeat,
        select=arguments.select,
        seed=arguments.seed,
        preset=arguments.preset,
        workers=arguments.workers or os.cpu_count() or 1,
    )
    result = run_suite(arguments.suite, load_suite(arguments.suite), options, progress=True)
    if to_file:
        write_json(Path(arguments.json_out), result)
    if arguments.json_out == "-":
        print(as_json(result))
    else:
        print(as_table({name: value for name, value in result.items() if name != "rows"}))
        _print_failures(result["rows"])
    return 0


def _print_failures(rows: list[dict[str, Any]]) -> None:
    failed = [row for row in rows if row["outcome"] != "arrived"]
    for row in failed[:SHOWN_FAILURES]:
        reason = (row.get("reason") or "no reason given").partition("\n")[0]
        print(f"mission {row['number']}: {row['outcome']}, {reason}")
    if len(failed) > SHOWN_FAILURES:
        print(f"and {len(failed) - SHOWN_FAILURES} more that did not arrive")
    if failed:
        print("run one again with --select and its number", file=sys.stderr)
