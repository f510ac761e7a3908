"""The figures of the README and of the targets are those of the run and the tables that they name."""

import gzip
import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from dynastar import io
from dynastar.bench.statistics import succeeded, wilson
from dynastar.io.examples import example_scenarios
from dynastar.metrics import measure
from dynastar.viewer.animation import animate_episode

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAPER = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
BENCHMARKS = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
CLOSE = 0.03  # of a figure: on another processor the robot may meet people at other times


@pytest.fixture(scope="module")
def demo():
    return io.run(example_scenarios()["office"])


def test_the_demos_figures_are_todays(demo):
    found = re.search(r"<!-- demo -->([\d.]+) s, ([\d.]+) m, (\d+) contacts<!-- end -->", README)
    seconds, metres, contacts = map(float, found.groups())
    result = measure(demo)
    assert result.outcome == "arrived"
    assert result.time == pytest.approx(seconds, rel=CLOSE)
    assert result.length == pytest.approx(metres, rel=CLOSE)
    assert result.contacts_moving + result.contacts_resting == contacts
    scenario = io.load_scenario(example_scenarios()["office"])
    said = re.search(r"lacks (\w+) obstacles and (\w+) walkers", README).groups()
    assert said == ("nine", "four")
    assert (len(scenario.obstacles), len(scenario.movers)) == (9, 4)


def test_the_animation_is_todays(demo, tmp_path):
    animate_episode(demo, tmp_path / "office.gif", max_seconds=1.0)
    last = [last_frame(tmp_path / "office.gif"), last_frame(ROOT / "docs" / "media" / "office.gif")]
    assert last[0].shape == last[1].shape
    below = slice(40, None)  # the upper strip says how much faster than life it runs
    apart = np.abs(last[0][below] - last[1][below]).max(axis=2) > 32
    assert apart.mean() < 0.01


def test_the_first_picture_moves_and_is_small():
    [name] = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)[:1]
    assert (ROOT / name).stat().st_size < 1_000_000
    with Image.open(ROOT / name) as image:
        assert image.n_frames > 50


def last_frame(path):
    with Image.open(path) as image:
        image.seek(image.n_frames - 1)
        return np.asarray(image.convert("RGB")).astype(int)


def table(name):
    """The rows of a table of the paper's page: cells by the first one."""
    part = PAPER.partition(f"<!-- {name} -->")[2].partition(f"<!-- end {name} -->")[0]
    rows = (re.split(r" *\| *", line.strip("| ")) for line in part.splitlines() if "|" in line)
    return {first: cells for first, *cells in rows}


def test_the_papers_figures_are_those_of_its_page():
    targets, length, time = table("targets"), table("table1-length"), table("table1-time")
    line = r"^\| ([^|]+) \| `dynastar paper \w+` \|[^|]*\| ([^|]+) \|"
    shown = dict(re.findall(line, BENCHMARKS, re.M))
    for row, wanted in (
        ("cells expanded over traditional A*, 1000 maps, median", [targets["cells, median, all"][1]]),
        ("length, fast smoothing, over traditional A*, median and 95th percentile",
         [length["improved, fast smoothing"][i] for i in (1, 3)]),
        ("search and fast smoothing over the traditional search, time",
         [targets["search and fast smoothing: time, median"][1]]),
    ):  # fmt: skip
        rounded = [f"{float(figure):.2f}" for figure in wanted]
        assert re.findall(r"\d\.\d+", shown[row]) == rounded, row
    ours = (time["improved, fast smoothing"], length["improved, fast smoothing"])
    others = (time["traditional, fast smoothing"], length["traditional, fast smoothing"])
    [said] = re.findall(r"^\| search, smoothed path.*", README, re.M)
    quartiles = [row[i] for row in (*ours, *others) for i in (1, 0, 2)]
    assert re.findall(r"\d\.\d\d", said) == [f"{float(figure):.2f}" for figure in quartiles]


def test_the_readmes_intervals_are_those_of_its_counts():
    found = re.findall(r"(\d+) of (\d+) \((\d+)-(\d+)\)", README)
    assert len(found) > 14
    for done, trials, low, high in found:
        interval = wilson(int(done), int(trials))
        assert [round(100.0 * end) for end in interval] == [int(low), int(high)], (done, trials)


def succeeded_of(part):
    """Missions that succeeded, and missions, by the rows kept of a part of `make results`."""
    kept = ROOT / "docs" / "measured" / f"{part}.json.gz"
    rows = json.loads(gzip.decompress(kept.read_bytes()))["rows"]
    return sum(map(succeeded, rows)), len(rows)


@pytest.mark.parametrize(
    ("suite", "row", "parts"),
    [
        ("barn", "BARN", ["barn"]),
        ("dynabarn", "DynaBARN", ["dynabarn"]),
        ("maps", "real maps", ["maps"]),
        ("people", "people who", ["people_late", "people_reactive"]),
    ],
)
def test_the_readmes_counts_are_those_of_the_benchmarks_page(suite, row, parts):
    [said] = re.findall(rf"^\| {row}.*", README, re.M)
    [cells] = re.findall(rf"^\| `{suite}` \| (\d+ of \d+ \(\d.*)", BENCHMARKS, re.M)
    navigator, *others = re.findall(r"\d+ of \d+", cells)
    ours, of_all, *theirs = re.findall(r"\d+ of \d+", said)
    assert ours == navigator
    assert sorted(theirs) == sorted(others)
    succeeded, missions = (sum(counts) for counts in zip(*map(succeeded_of, parts), strict=True))
    assert of_all == f"{succeeded} of {missions}"


def test_the_readme_is_short():
    assert len(README.splitlines()) <= 110


def test_the_missions_in_the_papers_worlds_are_those_of_its_page():
    row = next(
        line for line in BENCHMARKS.splitlines() if "| worlds like the paper's: arrived" in line
    )
    table = PAPER.partition("<!-- table3-presets -->")[2]
    line = r"^\| default \| (\d+) \| (\d+) \|[^|]*\| (\d+) \|"
    worlds, arrived, moving = map(int, re.search(line, table, re.M).groups())
    assert worlds == 1000  # what `dynastar paper table3` drives
    shown = rf"{arrived} of {worlds} \(\S+\), {moving} of {worlds} \(\S+\) moving contacts"
    assert re.search(rf"\| `dynastar paper table3` \|[^|]*\| {shown}(: missed)? \|", row)
