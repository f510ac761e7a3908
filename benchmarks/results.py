"""Measures all that the pages show, part by part, on the commit that is checked out; writes the pages.

    python benchmarks/results.py --data DIR                # what is left to measure, then the pages
    python benchmarks/results.py --list                    # the parts, and which are done
    python benchmarks/results.py --data DIR --only barn    # one part, then the pages
    python benchmarks/results.py --data DIR --pages        # only the pages, from what is there
    python benchmarks/results.py --data DIR --missions 2   # a trial, which is never written into pages

Results are in out/results, one JSON a part; with the pages they are kept in docs/measured, from where
another clone takes them. A part is done if its result is of its command on the sources (`src`) of HEAD;
one that was cut off goes on where it ended.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import NamedTuple

import results_kept
import results_pages
from results_kept import is_begun, is_done, read_record
from results_parts import Part, missing, parts

import dynastar
from dynastar import io
from dynastar.bench.selection import REPORT_SEEDS

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "out" / "results"
KEPT = ROOT / "docs" / "measured"
IMPORTED = Path(dynastar.__file__).resolve().parent


class Source(NamedTuple):
    """The sources that are measured: their tree, and the last commit that changed them."""

    tree: str
    commit: str


def git(*words: str) -> str:
    """What a command of git prints."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def source() -> Source:
    """The sources of HEAD."""
    return Source(git("rev-parse", "HEAD:src"), git("log", "-1", "--format=%h", "--", "src"))


def check_sources() -> None:
    """Refuses to measure sources that are not those of HEAD."""
    if IMPORTED != ROOT / "src" / "dynastar":
        raise SystemExit(
            f"dynastar is imported from {IMPORTED}: run with PYTHONPATH={ROOT / 'src'}"
        )
    if git("status", "--porcelain", "--", "src"):
        raise SystemExit("src has changes that are not committed: commit them first")


def check_extras() -> None:
    """Refuses to measure without the packages of all parts."""
    if found := missing():
        raise SystemExit(
            f"packages are missing: pip install -e '.[{','.join(found)}]' in this clone"
        )


def machine() -> str:
    """The processor's model and its cores."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {os.cpu_count()} cores"


def command_of(part: Part, folder: Path, missions: int | None) -> list[str]:
    """The command line of a part, of which a trial does a few ``missions``."""
    words = [sys.executable, *part.command, "--seed", str(REPORT_SEEDS)]
    words += ["--json-out", str(folder / f"{part.name}.json")]
    if part.of_paper:
        words += ["--out", str(folder / "paper")]
    if missions is not None:
        words += ["--maps" if part.of_paper else "--missions", str(missions)]
    return words


def measure(part: Part, folder: Path, sources: Source, missions: int | None) -> bool:
    """Runs a part and adds it to the record, also where it is cut off; True if it came to its end."""
    record = read_record(folder)
    before = record.get(part.name, {})
    goes_on = is_begun(part, record, sources.tree) and not before["complete"]
    spent = before["minutes"] if goes_on else 0.0
    began, code = time.monotonic(), None
    try:
        code = subprocess.run(command_of(part, folder, missions), cwd=ROOT, check=False).returncode
    finally:
        minutes = round(spent + (time.monotonic() - began) / 60.0, 1)
        of = {**sources._asdict(), "machine": machine(), "date": date.today().isoformat()}
        of |= {"command": " ".join(part.command), "minutes": minutes}
        record[part.name] = {**of, "complete": code == 0}
        io.write_json(folder / "record.json", record)
    print(f"{part.name}: {minutes} min" if code == 0 else f"{part.name}: FAILED", flush=True)
    return code == 0


def measure_all(
    asked: Sequence[Part], folder: Path, sources: Source, missions: int | None
) -> list[str]:
    """Runs the parts that are not done, and says what is left; the names of those that failed."""
    folder.mkdir(parents=True, exist_ok=True)
    record = read_record(folder)
    left = [part for part in asked if not is_done(part, record, sources.tree, folder)]
    failed = []
    while left:
        minutes = sum(part.minutes for part in left)
        print(f"{len(left)} parts left, about {minutes} min; now {left[0].name}", flush=True)
        part = left.pop(0)
        if not measure(part, folder, sources, missions):
            failed.append(part.name)
    return failed


def show(everything: Sequence[Part], sources: Source) -> None:
    """Prints the parts with their minutes, and which are done."""
    here, kept = read_record(FOLDER), read_record(KEPT)
    for part in everything:
        done = [
            record[part.name]["minutes"]
            for record, folder in ((here, FOLDER), (kept, KEPT))
            if is_done(part, record, sources.tree, folder)
        ]
        state = f"done in {done[0]} min" if done else ""
        print(f"{part.name:24} about {part.minutes:3} min  {state}")
    print(f"{'all':24} about {sum(part.minutes for part in everything):3} min")


def write_pages(everything: Sequence[Part], sources: Source) -> bool:
    """Keeps what was measured on these sources and writes the pages; whether all blocks could be."""
    record = read_record(FOLDER)
    done = [p.name for p in everything if is_done(p, record, sources.tree, FOLDER)]
    if not done:
        raise SystemExit(f"no part was measured on the sources of {sources.commit}")
    read = {name: (FOLDER / f"{name}.json").read_text(encoding="utf-8") for name in done}
    found = {name: json.loads(text) for name, text in read.items()}
    results_kept.keep(FOLDER, KEPT, sources.tree, os.environ["DYNASTAR_DATA"])
    results_pages.copy_pictures(FOLDER / "paper", done)
    lines, whole = results_pages.write(ROOT, found, {name: record[name] for name in done})
    print("\n".join(lines))
    return whole


def main(words: Sequence[str] | None = None) -> int:
    """Runs the command; 1 if a part failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", metavar="DIR", help="public data sets (default $DYNASTAR_DATA)")
    parser.add_argument("--only", nargs="+", metavar="PART", help="only these parts")
    parser.add_argument("--list", action="store_true", help="print the parts")
    parser.add_argument("--pages", action="store_true", help="measure nothing")
    parser.add_argument(
        "--missions", type=int, metavar="N", help="a trial: N missions of each part"
    )
    arguments = parser.parse_args(words)
    sources, everything = source(), parts()
    data = arguments.data or os.environ.get("DYNASTAR_DATA")
    if data:
        results_kept.restore(KEPT, FOLDER, sources.tree, os.path.abspath(data))
    if arguments.list:
        show(everything, sources)
        return 0
    if not data or not Path(data).is_dir():
        parser.error("give the folder of the public data sets: --data DIR, or DYNASTAR_DATA")
    os.environ["DYNASTAR_DATA"] = os.path.abspath(data)
    unknown = set(arguments.only or ()) - {part.name for part in everything}
    if unknown:
        parser.error(f"no part is called {', '.join(sorted(unknown))}; see --list")
    trial = arguments.missions is not None
    failed: list[str] = []
    if not arguments.pages:
        if not trial:
            check_sources()
            check_extras()
        asked = [part for part in everything if part.name in (arguments.only or (part.name,))]
        folder = FOLDER / "trial" if trial else FOLDER
        if trial:
            shutil.rmtree(folder, ignore_errors=True)
        failed = measure_all(asked, folder, sources, arguments.missions)
    whole = trial or write_pages(everything, sources)
    if failed:
        print(f"failed: {', '.join(failed)}")
    return 0 if whole and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
