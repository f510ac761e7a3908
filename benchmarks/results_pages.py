"""Writes what was measured into the pages: each block between its markers, and what it was measured on.

A block is written as soon as all of its parts are there. At its top a page says on which commit, machine
and day it was measured; while parts are missing it names the blocks that are of that commit.
"""

import shutil
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import results_quality as quality
import results_tables as tables
import scoreboard_page as scoreboard
import simulators_page as simulators
from contact_causes import PARTS as CONTACT_PARTS
from results_parts import INDIFFERENT, MAPS_BESIDE, parts
from results_targets import TARGETS, targets_table

from dynastar.bench.figures import FIGURES
from dynastar.bench.report import report_targets
from dynastar.bench.tables import as_markdown, fill
from dynastar.writing import written_aside

Found = Mapping[str, Any]  # the result of each part
Record = Mapping[str, Mapping[str, Any]]  # of each part: tree, commit, machine, date, minutes

README, BENCHMARKS, PAPER = "README.md", "docs/benchmarks.md", "docs/paper.md"
TABLES = {  # of the paper's page, by part
    "presets": ("presets",),
    "table1": tuple(
        f"table1-{name}" for name in ("own", "kinds", "cells", "length", "time", "512")
    ),
    "table3": ("table3-own", "table3", "table3-presets", "table3-driving"),
    "clutter": ("clutter", "walker"),
    "ladder": ("ladder",),
    "ablation": ("terms-cells", "terms-time", "terms", "ablation-paper", "ablation-people"),
}
PICTURES = {  # of the paper's page, by part
    "figures": tuple(FIGURES),
    "table1": ("table1",),
    "table3": ("table3",),
    "ladder": ("ladder",),
    "ablation": ("ablation",),
}


class Block(NamedTuple):
    """What stands between two markers of a page, the parts that it needs, and what writes it."""

    page: str
    name: str
    parts: tuple[str, ...]
    text: Callable[[Found], str]


def of_scoreboard(name: str, text: Callable[[Any], str]) -> Block:
    """A block of docs/benchmarks.md that is made of the scoreboard alone."""
    return Block(BENCHMARKS, name, ("scoreboard",), lambda found: text(found["scoreboard"]))


def paper_table(part: str, name: str, found: Found) -> str:
    """A table of `dynastar paper`, the ladder's with its picture."""
    table: str = found[part]["tables"][name]
    if name == "ladder":
        table += "\n\n![From print to robot](media/paper/ladder.png)"
    return table


def paper_targets(found: Found) -> str:
    """The table of the paper page's targets."""
    [table] = report_targets({**found["table1"], **found["table3"]}).tables
    return as_markdown(table)


def failures(everything: Mapping[str, Any]) -> dict[str, dict[str, list[int]]]:
    """Numbers of the navigator's missions of the scoreboard that failed, by kind and suite."""
    return scoreboard.failures(everything["suites"])


VARIANTS = ("crowdnav", "crowdnav_variants", "crowdnav_orca")
ATTENTION = ("people_late", "people_none", "people_reactive", "crowd_late", "crowd_none")
ALL = {part.name: part for part in parts()}
INDIFFERENTS = tuple(name for name in ALL if name.partition("-")[0] == INDIFFERENT)


def available(names: Iterable[str]) -> tuple[str, ...]:
    """Those of some parts that can be run here: their extras are installed."""
    return tuple(name for name in names if name in ALL)


BLOCKS = (
    of_scoreboard("scoreboard", lambda of: scoreboard.scoreboard(of["suites"])),
    of_scoreboard("failures", lambda of: scoreboard.failures_table(failures(of))),
    of_scoreboard("limits", lambda of: scoreboard.limits_table(of["suites"])),
    of_scoreboard("controllers", scoreboard.controllers_table),
    of_scoreboard("pictures", lambda of: scoreboard.pictures(failures(of))),
    Block(BENCHMARKS, "attention", available(ATTENTION), tables.attention_table),
    Block(BENCHMARKS, "quality", ("maps", MAPS_BESIDE), quality.quality_table),
    Block(BENCHMARKS, "near", available(quality.AMONG_PEOPLE), quality.near_table),
    Block(BENCHMARKS, "crowdnav", VARIANTS, tables.crowdnav_table),
    Block(
        BENCHMARKS,
        "variants",
        VARIANTS,
        lambda found: tables.variants_table({part: found[part] for part in VARIANTS}),
    ),
    Block(BENCHMARKS, "dynabarn-slow", ("dynabarn_slow",), tables.slow_table),
    Block(
        BENCHMARKS,
        "targets",
        available(dict.fromkeys(target.part for target in TARGETS)),
        lambda found: targets_table(found, ALL),
    ),
    Block(BENCHMARKS, "causes", ("contact_causes", *available(CONTACT_PARTS)), tables.causes_table),
    Block(BENCHMARKS, "irsim", ("irsim",), lambda found: simulators.irsim(found["irsim"])),
    Block(
        BENCHMARKS,
        "navground",
        ("navground",),
        lambda found: simulators.navground(found["navground"]),
    ),
    Block(BENCHMARKS, "speed", ("barn",), tables.speed),
    *(
        Block(PAPER, name, (part,), partial(paper_table, part, name))
        for part, names in TABLES.items()
        for name in names
    ),
    Block(PAPER, "targets", ("table1", "table3"), paper_targets),
    Block(
        README,
        "results",
        ("scoreboard", *INDIFFERENTS, "crowdnav", "crowdnav_orca", "navground", "table1"),
        tables.readme_table,
    ),
)
PAGES = tuple(dict.fromkeys(block.page for block in BLOCKS))


def parts_of(page: str) -> list[str]:
    """Names of the parts that a page shows."""
    names = [name for block in BLOCKS if block.page == page for name in block.parts]
    return list(dict.fromkeys([*names, *(PICTURES if page == PAPER else ())]))


def blocks_of(page: str, parts: Container[str]) -> list[Block]:
    """The blocks of a page whose parts are all there."""
    of = (block for block in BLOCKS if block.page == page)
    return [block for block in of if all(part in parts for part in block.parts)]


def header(page: str, record: Record, failed: Container[str] = ()) -> str:
    """What a page says at its top: commit, machine and day, and which blocks, while some are missing.

    ``failed`` names blocks that could not be written.
    """
    blocks = [block for block in blocks_of(page, record) if block.name not in failed]
    shown = [record[name] for name in {name for block in blocks for name in block.parts}]
    if not shown:
        return "The figures of this page are of earlier commits."
    commits, machines, days = (
        sorted({of[key] for of in shown}) for key in ("commit", "machine", "date")
    )
    when = days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}"
    words = f"Measured on commit {', '.join(commits)} ({'; '.join(machines)}; {when})"
    if not failed and all(name in record for name in parts_of(page)):
        return f"{words}."
    names = ", ".join(f"`{block.name}`" for block in blocks)
    return f"{words}: {names}. All other figures of this page are of earlier commits."


def write(root: Path, found: Found, record: Record) -> tuple[list[str], bool]:
    """Writes the pages; what was written, in words, and whether each block could be."""
    said, whole = [], True
    for page in PAGES:
        file = root / page
        document = file.read_text(encoding="utf-8")
        blocks, failed = blocks_of(page, found), []
        for block in blocks:
            try:
                text = block.text(found).strip()
            except Exception as error:
                failed.append(block.name)
                said.append(f"{page}: {block.name} is left as it was: {error!r}")
                continue
            document = fill(document, block.name, text, file)
        whole = whole and not failed
        document = fill(document, "measured", header(page, record, failed), file)
        with written_aside(file) as aside:
            aside.write_text(document, encoding="utf-8")
        missing = [name for name in parts_of(page) if name not in found]
        left = f"; missing: {', '.join(missing)}" if missing else ""
        said.append(f"{page}: {len(blocks) - len(failed)} blocks{left}")
    return said, whole


def copy_pictures(folder: Path, done: Sequence[str]) -> None:
    """Copies the paper's pictures of the parts that are done to where its page shows them.

    Of a part that was measured in another clone they are there already.
    """
    for part in PICTURES:
        for name in PICTURES[part] if part in done else ():
            if (picture := folder / f"{name}.png").is_file():
                shutil.copy(picture, Path(scoreboard.DOCS, "media", "paper"))
