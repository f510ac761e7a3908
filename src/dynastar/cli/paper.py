"""``dynastar paper``: the paper's tables and figures, remade."""

import argparse
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dynastar.bench.report import REPORTS, Asked, Report, report_targets, write
from dynastar.bench.settings import read_settings
from dynastar.bench.tables import Table, as_markdown, as_text, fill
from dynastar.cli.compiling import prepare
from dynastar.cli.outputs import check_file
from dynastar.cli.show import as_json
from dynastar.errors import InputError
from dynastar.extras import require
from dynastar.io.files import write_json, written_aside


def execute(arguments: argparse.Namespace) -> int:
    """Makes what is asked for; prints its tables, or JSON, and writes its files into the folder."""
    require("bench", "the tables and figures need")
    file = check_file("--json-out", arguments.json_out)
    if arguments.set and arguments.what in ("table1", "figures"):
        raise InputError(
            f"--set has no effect: {arguments.what} does not run a navigator to be set"
        )
    settings = read_settings(arguments.set, "default")
    if arguments.docs is not None:
        _check(arguments.docs)
    asked = Asked(
        arguments.maps,
        min(arguments.worlds, arguments.maps),
        arguments.seed,
        arguments.out or Path("out/paper"),
        arguments.workers or os.cpu_count() or 1,
        progress=True,
        settings=settings,
    )
    prepare()
    names = list(REPORTS) if arguments.what == "all" else [arguments.what]
    result: dict[str, Any] = {"seed": asked.seed, "maps": asked.maps}

    def give(report: Report) -> None:
        write(report, asked.folder)
        result.update(report.found)
        if arguments.docs is not None:
            _fill(arguments.docs, report.tables)
        if arguments.json_out != "-":
            for table in report.tables:
                print(as_text(table), end="\n\n", flush=True)

    for name in names:
        give(REPORTS[name](asked))
    if arguments.what == "all":
        give(report_targets(result))
    if file is not None:
        write_json(file, result)
    if arguments.json_out == "-":
        print(as_json(result))
    else:
        print(f"written into {asked.folder}")
    return 0


def _check(file: Path) -> None:
    """Before hours of work: that a page is there and every place for a table in it is closed."""
    if not file.is_file():
        raise InputError(f"--docs {file}: there is no such file")
    try:
        document = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"--docs {file}: is no text in UTF-8 ({error})") from None
    for name in re.findall(r"<!-- (?!end )([\w-]+) -->", document):
        fill(document, name, "", file)


def _fill(file: Path, tables: Sequence[Table]) -> None:
    """Puts the tables where the page has a place for them."""
    document = file.read_text(encoding="utf-8")
    for table in tables:
        if f"<!-- {table.name} -->" in document:
            document = fill(document, table.name, as_markdown(table), file)
    with written_aside(file) as aside:
        aside.write_text(document, encoding="utf-8")
