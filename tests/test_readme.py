"""The README's figures are those of the run and the tables that they name."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from dynastar import io
from dynastar.io.examples import example_scenarios
from dynastar.metrics import measure
from dynastar.viewer.animation import animate_episode

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAPER = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
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


def last_frame(path):
    with Image.open(path) as image:
        image.seek(image.n_frames - 1)
        return np.asarray(image.convert("RGB")).astype(int)


def test_the_papers_figures_are_those_of_its_page():
    """Each figure of a row that `dynastar paper` measures is in the table of targets, as it is rounded."""
    targets = PAPER.partition("<!-- targets -->")[2].partition("<!-- end targets -->")[0]
    line = r"^\| ([^|]+) \|[^|]*\| ([^|]+) \|"
    measured = dict(re.findall(line, targets, re.M))
    line = r"^\| ([^|]+) \| `dynastar paper \w+` \|[^|]*\| ([^|]+) \|"
    shown = dict(re.findall(line, README, re.M))
    for row, names, digits in (
        ("cells expanded over traditional A*, 1000 maps, median", ["cells, median, all"], 2),
        ("length over traditional A*, median and 95th percentile",
         ["any angle: length, median", "any angle: length, p95, all"], 2),
        ("search and smoothing over the traditional search, time",
         ["search and fast smoothing: time, median"], 2),
    ):  # fmt: skip
        wanted = [f"{float(measured[name]):.{digits}f}" for name in names]
        assert re.findall(r"\d\.\d+", shown[row]) == wanted, row


def test_the_missions_in_the_papers_worlds_are_those_of_its_page():
    row = next(line for line in README.splitlines() if "worlds like the paper's" in line)
    table = PAPER.partition("<!-- table3-presets -->")[2]
    line = r"^\| default \| (\d+) \| (\d+) \|[^|]*\| (\d+) \|"
    worlds, arrived, moving = map(int, re.search(line, table, re.M).groups())
    assert worlds == 1000  # what `dynastar paper table3` drives
    shown = f"{100.0 * arrived / worlds:.1f} %, {100.0 * moving / worlds:.1f} % of {worlds}"
    assert re.search(rf"\| `dynastar paper table3` \|[^|]*\| {re.escape(shown)}(: missed)? \|", row)
