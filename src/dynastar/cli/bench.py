"""``dynastar bench``: suites of missions, every failure counted; all of them; results compared."""

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dynastar.bench.controllers import controller_named
from dynastar.bench.keeping import FailureKeeper
from dynastar.bench.missions import Options
from dynastar.bench.runner import run_suite
from dynastar.bench.settings import read_settings
from dynastar.bench.statistics import succeeded
from dynastar.bench.suites import SUITES, load_suite
from dynastar.bench.tables import Cell, Table, as_text
from dynastar.cli.compiling import prepare
from dynastar.cli.outputs import check_file, make_folder
from dynastar.cli.show import as_json, as_table
from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.extras import require
from dynastar.io.files import write_json

SHOWN_FAILURES = 20
NOT_SHOWN = ("rows", "groups", "published", "comparable", "settings", "limited")
OF_GROUPS = ("missions", "succeeded", "contacts_moving", "contacts_resting", "score", "time_ratio")
COMMANDS = {"all": "run every suite", "compare": "compare two results"}


def execute(arguments: argparse.Namespace) -> int:
    """Runs a suite, all of them, or one mission again, or compares two results."""
    require("bench", "the suites' statistics and pictures need")
    if arguments.suite == "compare":
        return _compare(arguments)
    if arguments.files:
        raise InputError(f"{arguments.files[0]}: only `bench compare` takes files")
    if arguments.suite == "all":
        return _run_all(arguments)
    choose(arguments.suite, {**SUITES, **COMMANDS}, "suite")
    options = _options(arguments)
    if arguments.replay is not None:
        return _replay(arguments, options)
    return _run(arguments, options)


def _run(arguments: argparse.Namespace, options: Options) -> int:
    suite = load_suite(arguments.suite)
    if not hasattr(suite, "scenario"):
        _refuse_driving(arguments)
    file = check_file("--json-out", arguments.json_out)
    if arguments.out is not None:
        raise InputError(
            "--out goes with `bench all` or --replay; --json-out FILE takes the result"
        )
    keep = None if file is None else _beside(file)
    prepare()
    result = run_suite(arguments.suite, suite, options, progress=True, keep=keep)
    _write(result, file, keep)
    if arguments.json_out == "-":
        print(as_json(result))
    else:
        _print_result(result)
        _print_failures(result["rows"])
    return 0


def _run_all(arguments: argparse.Namespace) -> int:
    from dynastar.bench.scoreboard import picture, run_all, table
    from dynastar.viewer.sheet import save

    for option in ("select", "missions", "replay"):
        if getattr(arguments, option) is not None:
            raise InputError(f"--{option} goes with one suite, not with `bench all`")
    options = _options(arguments)
    folder = make_folder("--out", arguments.out or Path("out/bench"))
    file = check_file("--json-out", arguments.json_out) or folder / "all.json"
    keep = _beside(file)
    prepare()
    result = run_all(options, progress=True, keep=keep)
    _write(result, file, keep)
    save(picture(result), folder / "all.png")
    text = as_text(table(result))
    (folder / "all.txt").write_text(text + "\n", encoding="utf-8")
    print(as_json(result) if arguments.json_out == "-" else text)
    print(f"the table and the picture are in {folder}, all rows in {file}", file=sys.stderr)
    return 0


def _replay(arguments: argparse.Namespace, options: Options) -> int:
    from dynastar.bench.keeping import replay
    from dynastar.cli.run import write_folder

    number, repeat = arguments.replay
    name = f"{arguments.suite}-{number}" + (f"-{repeat}" if repeat else "")
    file = check_file("--json-out", arguments.json_out)
    folder = make_folder("--out", arguments.out or Path("out", name))
    suite = load_suite(arguments.suite)
    prepare()
    row, episode = replay(arguments.suite, suite, options, number, repeat, folder)
    write_folder(folder, episode, row, gif=not arguments.no_gif)
    print(f"pictures, numbers and the episode are in {folder}", file=sys.stderr)
    if file is not None:
        write_json(file, row)
    print(as_json(row) if arguments.json_out == "-" else as_table(row))
    return 0


def _compare(arguments: argparse.Namespace) -> int:
    from dynastar.bench.compare import as_lines, compare, load_result

    if len(arguments.files) != 2:
        raise InputError("bench compare takes two results: dynastar bench compare A.json B.json")
    file = check_file("--json-out", arguments.json_out)
    compared = compare(*map(load_result, arguments.files))
    if file is not None:
        write_json(file, compared)
    print(as_json(compared) if arguments.json_out == "-" else "\n".join(as_lines(compared)))
    return 0


def _options(arguments: argparse.Namespace) -> Options:
    """The options of a suite from the arguments, checked before it is run."""
    controller_named(arguments.controller)
    observe = None
    if arguments.save_failures is not None:
        observe = FailureKeeper(make_folder("--save-failures", arguments.save_failures))
    return Options(
        data=arguments.data,
        missions=arguments.missions,
        repeat=arguments.repeat,
        select=arguments.select,
        seed=arguments.seed,
        preset=arguments.preset,
        workers=arguments.dask or arguments.workers or os.cpu_count() or 1,
        ideal=arguments.ideal,
        controller=arguments.controller,
        settings=read_settings(arguments.set, arguments.preset),
        quick=arguments.quick,
        observe=observe,
    )


def _refuse_driving(arguments: argparse.Namespace) -> None:
    """Refuses options that a suite which drives nothing would leave unheard."""
    asked = {
        "--controller": arguments.controller != "navigator",
        "--set": arguments.set,
        "--save-failures": arguments.save_failures is not None,
        "--ideal": arguments.ideal,
    }
    for option in (name for name, given in asked.items() if given):
        raise InputError(f"{option} has no effect: the suite {arguments.suite} drives nothing")


def _beside(file: Path) -> Path:
    """Where finished rows are kept until the result is written."""
    return file.with_name(f"{file.name}.rows.jsonl")


def _write(result: Mapping[str, Any], file: Path | None, keep: Path | None) -> None:
    if file is not None:
        write_json(file, result)
    if keep is not None:
        keep.unlink(missing_ok=True)


def _print_result(result: Mapping[str, Any]) -> None:
    shown = {name: value for name, value in result.items() if name not in NOT_SHOWN}
    for name, value in shown.items():
        if name.endswith("_interval"):
            shown[name] = None if value is None else f"{value[0]:.3f} to {value[1]:.3f}"
    if result["settings"]:
        shown["settings"] = as_json(result["settings"])
    print(as_table(shown))
    if result["limited"]:
        seconds = (f"{cause} {spent:.0f} s" for cause, spent in result["limited"].items())
        print(f"limited by: {', '.join(seconds)}")
    if len(result["groups"]) > 1:
        lines: list[tuple[Cell, ...]] = [
            (name, *(of[key] for key in OF_GROUPS)) for name, of in result["groups"].items()
        ]
        formats = ("d", "d", "d", "d", ".3f", ".2f")
        columns = (("group", ""), *zip(OF_GROUPS, formats, strict=True))
        print(f"\n{as_text(Table('groups', '', columns, lines))}")
    for published in result["published"]:
        print(f"published: {published['label']}: {published['figure']} [{published['source']}]")
    if result["comparable"]:
        print(result["comparable"])


def _print_failures(rows: Sequence[Mapping[str, Any]]) -> None:
    failed = [row for row in rows if not succeeded(row)]
    for row in failed[:SHOWN_FAILURES]:
        reason = (row.get("reason") or "no reason given").partition("\n")[0]
        repeat = f":{row['repeat']}" if row.get("repeat") else ""
        judged = ", but not as the suite asks" if row.get("right") is False else ""
        print(f"mission {row['number']}{repeat}: {row['outcome']}{judged}, {reason}")
    if len(failed) > SHOWN_FAILURES:
        print(f"and {len(failed) - SHOWN_FAILURES} more that failed")
    if failed:
        print("run one again with --replay and its number", file=sys.stderr)
