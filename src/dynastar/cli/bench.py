"""``dynastar bench``: suites of missions, every failure counted; all of them; results compared."""

import argparse
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar import io
from dynastar.bench.suites import SUITES, WITHOUT_DATA, load_suite
from dynastar.cli.arguments import ATTENTIONS, PRESETS, add_set
from dynastar.cli.outputs import check_file, make_folder
from dynastar.cli.parsing import count, path, refuse_unheard, replayed, seed
from dynastar.cli.show import as_json, as_table
from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.extras import require
from dynastar.writing import written_aside

if TYPE_CHECKING:
    from dynastar.bench.missions import Options

DESCRIPTION = (
    "Runs a suite of missions, or all of them, and counts every failure; runs a mission "
    "again; compares two results."
)

EXAMPLES = """\
examples:
  dynastar bench movingai --data data/movingai
  dynastar bench barn --data data --workers 2 --json-out barn.json
  dynastar bench barn --replay 17               # mission 17 again, with pictures and the episode
  dynastar bench barn --set dwa.horizon=2 --save-failures out/failures --json-out b.json
  dynastar bench maps --controller pure_pursuit
  dynastar bench scenarios --data examples/features
  dynastar bench all --quick --data data --out out/bench
  dynastar bench compare barn.json b.json

A mission has the suite's own number. A run with --json-out that was cut off goes on where it ended when
it is called again; until then its rows are in FILE.rows.jsonl. `all` runs every suite whose data and
extras are there, also by the other controllers that are installed, and writes all.json, all.txt and all.png
into DIR. `compare` takes two results of the
same missions and says for each suite whether the second is better, worse or not clearly different."""

# Options with their defaults: which missions are run, and how they are driven.
CHOOSING: dict[str, object] = {
    "select": None, "missions": None, "repeat": 1, "quick": False, "save_failures": None,
}  # fmt: skip
DRIVING: dict[str, object] = {
    "controller": None, "set": [], "save_failures": None, "ideal": False, "attention": None,
    "legs": False,
}  # fmt: skip
UNCOMPARED: dict[str, object] = CHOOSING | DRIVING | {
    "data": None, "seed": 0, "preset": None, "workers": None, "dask": None, "replay": None, "out": None,
    "no_gif": False,
}  # fmt: skip
COMMANDS = {"all": "run every suite", "compare": "compare two results"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    _add_missions(parser)
    _add_results(parser)


def _add_missions(parser: argparse.ArgumentParser) -> None:
    """Add what says which missions are run, and how."""
    parser.add_argument(
        "suite",
        metavar="SUITE",
        help=f"{', '.join(SUITES)}; `all` for all of them, `compare` for two results",
    )
    parser.add_argument("files", nargs="*", metavar="FILE", help="two results, for `compare`")
    parser.add_argument(
        "--data",
        type=path,
        metavar="DIR",
        help="the suite's folder or the one above it (default $DYNASTAR_DATA)",
    )
    parser.add_argument(
        "--missions", type=count, metavar="N", help="run N missions, those left out not counted"
    )
    parser.add_argument("--repeat", type=count, default=1, metavar="N", help="each mission N times")
    parser.add_argument(
        "--select",
        metavar="A:B:C",
        help="a slice over the suite's own numbers, some of them (3,7,20), or both (0:9,20::4)",
    )
    parser.add_argument(
        "--seed",
        type=seed,
        default=0,
        metavar="N",
        help="of what is drawn at random (default 0); from 10000 on for published tables only",
    )
    parser.add_argument("--preset", choices=PRESETS, help="default: that of the scenarios")
    parser.add_argument(
        "--ideal", action="store_true", help="without range noise and without latency"
    )
    parser.add_argument(
        "--attention",
        choices=ATTENTIONS,
        help="of scripted walkers: late (the default of people and crowd), or none",
    )
    parser.add_argument(
        "--legs",
        action="store_true",
        help="the lidar of this simulator sees walkers' legs, not bodies",
    )
    parser.add_argument(
        "--controller",
        metavar="NAME",
        help="navigator (the default), pure_pursuit, printed, kompass_dwa, orca, or MODULE:CLASS; `all` "
        "runs all of these (--quick: all but printed, in one mission of six) unless one is named",
    )
    add_set(parser)
    parser.add_argument(
        "--quick", action="store_true", help="a few missions of the suite, or of each"
    )
    parser.add_argument("--workers", type=count, metavar="N", help="processes (default: all cores)")
    parser.add_argument(
        "--dask", metavar="ADDRESS", help="run on this Dask cluster instead, as tcp://host:8786"
    )


def _add_results(parser: argparse.ArgumentParser) -> None:
    """Add what says where the results go."""
    parser.add_argument(
        "--json-out", metavar="FILE", help="the result with a row for every mission; - is stdout"
    )
    parser.add_argument(
        "--save-failures",
        type=path,
        metavar="DIR",
        help="write the episode (.npz) and a picture (.png) of each mission that failed into DIR",
    )
    parser.add_argument(
        "--replay",
        type=replayed,
        metavar="N",
        help="run mission N again (its repeat R: N:R) and write what `run` writes",
    )
    parser.add_argument(
        "--out",
        type=path,
        metavar="DIR",
        help="of --replay (default out/SUITE-N) and `all` (out/bench)",
    )
    parser.add_argument("--no-gif", action="store_true", help="leave out the animation of --replay")


def execute(arguments: argparse.Namespace) -> int:
    """Runs a suite, all of them, or one mission again, or compares two results."""
    require("bench", "the suites' statistics and pictures need")
    if arguments.suite == "compare":
        return _compare(arguments)
    if arguments.files:
        raise InputError(f"{arguments.files[0]}: only `bench compare` takes files")
    if arguments.replay is None:
        refuse_unheard(arguments, {"no_gif": False}, "leaves out the animation of --replay N alone")
    if arguments.suite == "all":
        return _run_all(arguments)
    choose(arguments.suite, {**SUITES, **COMMANDS}, "suite")
    if arguments.suite in WITHOUT_DATA:
        why = f"has no effect: the suite {arguments.suite} reads no data"
        refuse_unheard(arguments, {"data": None}, why)
    if arguments.replay is not None:
        several = CHOOSING | {"workers": None, "dask": None}
        refuse_unheard(arguments, several, "has no effect with --replay, which runs one mission")
        return _replay(arguments, _options(arguments))
    return _run(arguments, _options(arguments))


def _run(arguments: argparse.Namespace, options: "Options") -> int:
    from dynastar.bench.runner import run_suite
    from dynastar.cli.bench_output import print_result
    from dynastar.cli.compiling import prepare

    suite = load_suite(arguments.suite)
    if not hasattr(suite, "scenario"):
        refuse_unheard(
            arguments, DRIVING, f"has no effect: the suite {arguments.suite} drives nothing"
        )
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
        print_result(result)
    return 0


def _run_all(arguments: argparse.Namespace) -> int:
    from dynastar.bench import scoreboard
    from dynastar.bench.scoreboard_tables import quality_table, table
    from dynastar.bench.tables import as_text
    from dynastar.cli.compiling import prepare
    from dynastar.viewer.sheet import save

    for option in ("select", "missions", "replay"):
        if getattr(arguments, option) is not None:
            raise InputError(f"--{option} goes with one suite, not with `bench all`")
    options = _options(arguments)
    folder = make_folder("--out", arguments.out or Path("out/bench"))
    file = check_file("--json-out", arguments.json_out) or folder / "all.json"
    keep = _beside(file)
    prepare()
    others: tuple[str, ...] = ()
    if arguments.controller is None:
        others = scoreboard.QUICK_COMPETITORS if arguments.quick else scoreboard.COMPETITORS
    every = scoreboard.QUICK_EVERY if arguments.quick else 1
    result = scoreboard.run_all(options, progress=True, keep=keep, others=others, every=every)
    _write(result, file, keep)
    save(scoreboard.picture(result), folder / "all.png")
    text = "\n\n".join(map(as_text, (table(result), quality_table(result))))
    with written_aside(folder / "all.txt") as aside:
        aside.write_text(text + "\n", encoding="utf-8", errors="backslashreplace")
    print(as_json(result) if arguments.json_out == "-" else text)
    print(f"the table and the picture are in {folder}, all rows in {file}", file=sys.stderr)
    return 0


def _replay(arguments: argparse.Namespace, options: "Options") -> int:
    from dynastar.bench.keeping import replay
    from dynastar.cli.compiling import prepare
    from dynastar.cli.run import write_folder

    number, repeat = arguments.replay
    name = f"{arguments.suite}-{number}" + (f"-{repeat}" if repeat else "")
    file = check_file("--json-out", arguments.json_out)
    folder = make_folder("--out", arguments.out or Path("out", name))
    suite = load_suite(arguments.suite)
    prepare()
    row, episode = replay(arguments.suite, suite, options, number, repeat)
    write_folder(folder, episode, row, gif=not arguments.no_gif)
    print(f"pictures, numbers and the episode are in {folder}", file=sys.stderr)
    if file is not None:
        io.write_json(file, row)
    print(as_json(row) if arguments.json_out == "-" else as_table(row))
    return 0


def _compare(arguments: argparse.Namespace) -> int:
    from dynastar.bench.compare import as_lines, compare, load_result

    if len(arguments.files) != 2:
        raise InputError("bench compare takes two results: dynastar bench compare A.json B.json")
    refuse_unheard(arguments, UNCOMPARED, "has no effect with `bench compare`, which runs nothing")
    file = check_file("--json-out", arguments.json_out, map(Path, arguments.files))
    compared = compare(*map(load_result, arguments.files))
    if file is not None:
        io.write_json(file, compared)
    print(as_json(compared) if arguments.json_out == "-" else "\n".join(as_lines(compared)))
    return 0


def _options(arguments: argparse.Namespace) -> "Options":
    """The options of a suite from the arguments, checked before it is run."""
    from dynastar.bench.controllers import controller_named
    from dynastar.bench.keeping import FailureKeeper
    from dynastar.bench.missions import Options
    from dynastar.bench.selection import refuse_report_seed
    from dynastar.bench.settings import read_settings

    controller = "navigator" if arguments.controller is None else arguments.controller
    controller_named(controller)
    if arguments.quick:
        refuse_report_seed(arguments.seed)
    observe = None
    if arguments.save_failures is not None:
        observe = FailureKeeper(make_folder("--save-failures", arguments.save_failures))
    return Options(
        data=arguments.data,
        missions=arguments.missions,
        repeat=arguments.repeat,
        select=arguments.select,
        seed=arguments.seed,
        preset=arguments.preset or "",
        workers=arguments.dask or arguments.workers or os.cpu_count() or 1,
        ideal=arguments.ideal,
        controller=controller,
        settings=read_settings(arguments.set, arguments.preset or "default"),
        quick=arguments.quick,
        attention=arguments.attention,
        legs=arguments.legs,
        observe=observe,
    )


def _beside(file: Path) -> Path:
    """Where finished rows are kept until the result is written."""
    return file.with_name(f"{file.name}.rows.jsonl")


def _write(result: Mapping[str, Any], file: Path | None, keep: Path | None) -> None:
    if file is not None:
        io.write_json(file, result)
    if keep is not None:
        keep.unlink(missing_ok=True)
