"""``dynastar paper``: the paper's tables, remade on many maps."""

import argparse
import csv
import os
from pathlib import Path
from typing import Any

from dynastar.bench import table1
from dynastar.cli.show import as_json
from dynastar.errors import InputError
from dynastar.io.files import write_json, written_aside

# Table I of the paper, on its one map: improved over traditional.
PRINTED = {"expanded_ratio": 0.499, "search_time_ratio": 0.305, "length_ratio": 0.972}


def execute(arguments: argparse.Namespace) -> int:
    """Makes Table I, prints it, and writes its rows into the folder."""
    to_file = arguments.json_out not in (None, "-")
    if to_file and not Path(arguments.json_out).absolute().parent.is_dir():
        raise InputError(f"--json-out {arguments.json_out}: its folder is not there; make it first")
    out = arguments.out or Path("out/paper")
    workers = arguments.workers or os.cpu_count() or 1
    rows = table1.run(arguments.maps, arguments.seed, out, workers, progress=True)
    _write_csv(out / "table1.csv", rows)
    result = {"seed": arguments.seed, "maps": len(rows), "table1": table1.summary(rows)}
    if to_file:
        write_json(arguments.json_out, result)
    print(as_json(result) if arguments.json_out == "-" else _table(result))
    return 0


def _table(result: dict[str, Any]) -> str:
    """One block for each kind of map: ratio, median, mean, 95th percentile, worst, the paper's."""
    lines = [f"Table I, improved over traditional A*, {result['maps']} maps, seed {result['seed']}"]
    for kind, ratios in result["table1"].items():
        lines += ["", f"{kind:28}{'median':>9}{'mean':>9}{'p95':>9}{'worst':>9}{'paper':>9}"]
        for name, spread in ratios.items():
            figures = "".join(f"{value:9.3f}" for value in spread.values())
            printed = f"{PRINTED[name]:9.3f}" if name in PRINTED else ""
            lines.append(f"{name:28}{figures}{printed}")
    return "\n".join(lines)


def _write_csv(file: Path, rows: list[dict[str, Any]]) -> None:
    """A line for each map: its kind and number, and each arm's cells, length and seconds."""
    flat = [
        {
            name if not isinstance(value, dict) else f"{name}: {what}": figure
            for name, value in row.items()
            for what, figure in (value.items() if isinstance(value, dict) else [("", value)])
        }
        for row in rows
    ]
    with written_aside(file) as aside, aside.open("w", newline="", encoding="utf-8") as handle:
        writer = csv.DictWriter(handle, list(flat[0]))
        writer.writeheader()
        writer.writerows(flat)
