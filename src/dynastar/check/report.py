"""A check as a folder: a page of HTML with its pictures beside it, and the findings as JSON."""

import html
import sys
from pathlib import Path

from dynastar.check.checking import Check
from dynastar.errors import MissingPackage
from dynastar.extras import require
from dynastar.io.files import write_json
from dynastar.writing import written_aside

PAGE = "report.html"
STYLE = """\
body { font: 16px/1.5 sans-serif; color: #22252b; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse } td, th { padding: .4rem .6rem; vertical-align: top; text-align: left }
tr { border-top: 1px solid #e2e4e7 } img { width: 100% }
.ok { color: #00614a } .warning { color: #8a5a00 } .problem { color: #b00016 }
.ok, .warning, .problem { font-weight: bold }"""
CAPTIONS = {
    "passages.png": "The map's passages between larger regions, with their widths in metres.",
    "stop.svg": "A stop from v_max seen from above, and its length over the speed.",
    "gaps.svg": "Time between the recorded messages.",
}


def write_check(check: Check, folder: Path, title: str) -> Path:
    """Writes report.html, its pictures and check.json into a folder; returns the page's path.

    Without Matplotlib there are no pictures, which is said on stderr.
    """
    write_json(folder / "check.json", check.as_data())
    try:
        pictures = _draw(check, folder)
    except MissingPackage as missing:
        print(f"without pictures: {missing}", file=sys.stderr)
        pictures = []
    with written_aside(folder / PAGE) as aside:
        aside.write_text(page(check, title, pictures), encoding="utf-8", errors="backslashreplace")
    return folder / PAGE


def _draw(check: Check, folder: Path) -> list[str]:
    """Writes the pictures and returns their names. Raises MissingPackage."""
    require("viewer", "pictures need")
    from dynastar.check import pictures
    from dynastar.viewer.sheet import save

    drawn = {}
    if check.grid is not None:
        drawn["passages.png"] = pictures.draw_passages(check)
    drawn["stop.svg"] = pictures.draw_stop(check.robot, check.config)
    if check.recording is not None:
        drawn["gaps.svg"] = pictures.draw_gaps(check.recording, check.config)
    for name, figure in drawn.items():
        save(figure, folder / name)
    return list(drawn)


def page(check: Check, title: str, pictures: list[str]) -> str:
    """The page; ``pictures`` are names of files beside it."""
    title = html.escape(f"{title}: {check.level}")
    rows = [
        f'<tr><td class="{one.level}">{one.level}</td><td>{html.escape(one.name)}</td>'
        f"<td>{html.escape(one.words())}</td></tr>"
        for one in check.findings
    ]
    figures = [
        f'<figure><img src="{name}" alt="{CAPTIONS[name]}"><figcaption>{CAPTIONS[name]}</figcaption>'
        "</figure>"
        for name in pictures
    ]
    return "\n".join(
        [
            '<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8">',
            f"<title>{title}</title><style>{STYLE}</style></head>",
            f"<body><h1>{title}</h1>\n<table>",
            "<tr><th>level</th><th>checked</th><th>finding</th></tr>",
            *rows,
            "</table>",
            *figures,
            "</body></html>\n",
        ]
    )
