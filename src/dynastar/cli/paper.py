"""``dynastar paper``: the paper's tables and figures, remade."""

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar import io
from dynastar.cli.arguments import add_set
from dynastar.cli.outputs import check_file, make_folder
from dynastar.cli.parsing import count, path, seed
from dynastar.cli.show import as_json
from dynastar.errors import InputError
from dynastar.extras import require

if TYPE_CHECKING:
    from dynastar.bench.report import Report

DESCRIPTION = "Remakes the paper's tables and figures, over as many maps as you like."

EXAMPLES = """\
examples:
  dynastar paper table1
  dynastar paper table3 --maps 100 --out out/hundred --json-out -
  dynastar paper all --json-out paper.json

  presets   the settings in which the presets paper and default differ
  table1    traditional against improved A*, on the generated map, over maps of 40 x 40 cells (random,
            rooms, maze, office; corner to corner), and over a tenth as many of 512 x 512; 2 minutes
  table3    the improved A* alone against the hybrid, in the generated world and over worlds of 20 x 20
            cells with unknown blocks and a mover, by the presets default and paper, a tenth of them by
            the controller printed, a fifth by the default with plain A*, and a fifth without a planner;
            80 minutes for 1000
  clutter   the controller printed in two readings, and the default, over worlds with 0 to 30 % of the
            map's cells occupied; the default over walkers' speeds; 30 minutes for 50 of each
  ladder    the controller printed made the default navigator, a change at a time, over worlds of the
            suite paper; 45 minutes for 200
  ablation  each term of Eqs. 2 and 9 left out or read otherwise, and each part of the whole, on worlds
            of the suites paper and people; 45 minutes for 50 of each
  figures   Figs. 1 to 8; 10 seconds

Times are for two cores. Writes tables (.md), a line for each map or world (.csv) and pictures (.png,
.svg) into DIR, and goes on from the .jsonl there where it was cut off."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "what",
        nargs="?",
        choices=("presets", "table1", "table3", "clutter", "ladder", "ablation", "figures", "all"),
        default="all",
        help="default all",
    )
    parser.add_argument(
        "--maps",
        type=count,
        default=1000,
        metavar="N",
        help="maps of table1, in fours, and worlds of table3 (default 1000)",
    )
    parser.add_argument(
        "--worlds",
        type=count,
        metavar="N",
        help="worlds of each suite in the ablation (default 100), of each density in clutter (50) "
        "and of ladder (200), no more than --maps",
    )
    parser.add_argument(
        "--seed",
        type=seed,
        default=10_000,
        metavar="N",
        help="of the maps and worlds (default 10000, that of the published tables; use one below it "
        "to compare versions of the code)",
    )
    parser.add_argument("--out", type=path, metavar="DIR", help="default out/paper")
    parser.add_argument("--workers", type=count, metavar="N", help="processes (default: all cores)")
    parser.add_argument(
        "--json-out",
        metavar="FILE",
        help="all figures, rows, and the tables in Markdown; - is stdout",
    )
    add_set(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Makes what is asked for; prints its tables, or JSON, and writes its files into the folder."""
    from dynastar.bench.report import REPORTS, Asked, report_targets, write
    from dynastar.bench.settings import read_settings
    from dynastar.bench.tables import as_markdown, as_text
    from dynastar.cli.compiling import prepare

    require("bench", "the tables and figures need")
    file = check_file("--json-out", arguments.json_out)
    if arguments.set and arguments.what in ("table1", "clutter", "figures", "presets"):
        raise InputError(
            f"--set has no effect: {arguments.what} does not run a navigator to be set"
        )
    settings = read_settings(arguments.set, "default")
    asked = Asked(
        arguments.maps,
        arguments.worlds,
        arguments.seed,
        make_folder("--out", arguments.out or Path("out/paper")),
        arguments.workers or os.cpu_count() or 1,
        progress=True,
        settings=settings,
    )
    prepare()
    names = list(REPORTS) if arguments.what == "all" else [arguments.what]
    result: dict[str, Any] = {"seed": asked.seed, "maps": asked.maps, "tables": {}, "rows": {}}

    def give(report: "Report") -> None:
        write(report, asked.folder)
        result.update(report.found)
        result["rows"].update(report.rows)
        result["tables"].update({table.name: as_markdown(table) for table in report.tables})
        if arguments.json_out != "-":
            for table in report.tables:
                print(as_text(table), end="\n\n", flush=True)

    for name in names:
        give(REPORTS[name](asked))
    if arguments.what == "all":
        give(report_targets(result))
    if file is not None:
        io.write_json(file, result)
    if arguments.json_out == "-":
        print(as_json(result))
    else:
        print(f"written into {asked.folder}")
    return 0
