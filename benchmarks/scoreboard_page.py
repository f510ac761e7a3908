"""Puts the table of a ``dynastar bench all`` into docs/benchmarks.md, between its markers.

python benchmarks/scoreboard_page.py out/bench/all.txt
"""

import sys
from pathlib import Path

PAGE = Path(__file__).parent.parent / "docs" / "benchmarks.md"
BEGIN, END = "<!-- scoreboard -->", "<!-- end of scoreboard -->"


def filled(page: str, table: str) -> str:
    """The page with the table as a code block between the markers."""
    before, _, rest = page.partition(BEGIN)
    _, found, after = rest.partition(END)
    if not found:
        raise SystemExit(f"{PAGE}: the markers {BEGIN} and {END} are not there")
    return f"{before}{BEGIN}\n```text\n{table.strip()}\n```\n{END}{after}"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8"), Path(sys.argv[1]).read_text()))
