"""The figures of an experiment, and its tables: for the terminal, for a page, for the docs."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dynastar.errors import InputError

Cell = str | int | float | None


def spread_of(values: Sequence[float]) -> dict[str, float]:
    """Median, mean, 95th percentile and the largest."""
    return {
        "median": float(np.median(values)),
        "mean": float(np.mean(values)),
        "p95": float(np.quantile(values, 0.95)),
        "worst": float(np.max(values)),
    }


class Table(NamedTuple):
    """Columns are (heading, format of a number, or "<" for words); None is blank. The first has words.

    ``notes`` say under the table what its words mean and where it comes from.
    """

    name: str
    title: str
    columns: tuple[tuple[str, str], ...]
    rows: Sequence[tuple[Cell, ...]]
    notes: str = ""

    @property
    def cells(self) -> list[list[str]]:
        """The headings and each row, as words."""
        formats = [format_ for _, format_ in self.columns]
        return [
            [heading for heading, _ in self.columns],
            *(
                [_words(cell, format_) for cell, format_ in zip(row, formats, strict=True)]
                for row in self.rows
            ),
        ]


def as_text(table: Table) -> str:
    """The table in columns, for a terminal."""
    cells = table.cells
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    left = _left_aligned(table)
    lines = [
        "  ".join(
            cell.ljust(width) if at in left else cell.rjust(width)
            for at, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in cells
    ]
    rule = "-" * max(map(len, lines))
    return "\n".join(filter(None, [table.title, rule, lines[0], rule, *lines[1:], table.notes]))


def as_markdown(table: Table) -> str:
    """The table for the docs."""
    first, *rows = table.cells
    left = _left_aligned(table)
    aligned = [":--" if at in left else "--:" for at in range(len(first))]
    lines = [f"| {' | '.join(row)} |" for row in (first, aligned, *rows)]
    parts = [f"**{table.title}**", "\n".join(lines), table.notes]
    # A star is one here, and not the begin of something bold.
    return "\n\n".join(part.replace("A*", "A\\*") for part in parts if part)


def _left_aligned(table: Table) -> set[int]:
    return {at for at, (_, format_) in enumerate(table.columns) if at == 0 or format_ == "<"}


def fill(document: str, name: str, text: str, where: Path) -> str:
    """A document whose part between ``<!-- name -->`` and ``<!-- end name -->`` is ``text`` now.

    Raises InputError, naming ``where``, if it has no such part.
    """
    begin, end = f"<!-- {name} -->", f"<!-- end {name} -->"
    before, found, rest = document.partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise InputError(f"{where} has no part between {begin} and {end}")
    return f"{before}{begin}\n{text}\n{end}{after}"


def _words(cell: Cell, format_: str) -> str:
    if cell is None:
        return ""
    return cell if isinstance(cell, str) else format(cell, format_)
