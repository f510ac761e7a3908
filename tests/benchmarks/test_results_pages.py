"""Pages are filled with what is there, and say at their top on what they were measured."""

import json
import re
import sys
from pathlib import Path

import pytest

from dynastar.bench.tables import fill

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "benchmarks"))
import results_pages as pages  # noqa: E402
from results_parts import parts  # noqa: E402

RECORD = json.loads((ROOT / "docs" / "measured" / "record.json").read_text(encoding="utf-8"))
EARLIER = "The figures of this page are of earlier commits."


def of(**changed):
    made = {"tree": "t", "commit": "abc1234", "machine": "AMD EPYC, 2 cores", "date": "2025-11-30"}
    return {**made, "minutes": 1.5, "complete": True, **changed}


def between(document, name):
    return document.partition(f"<!-- {name} -->\n")[2].partition(f"\n<!-- end {name} -->")[0]


@pytest.mark.parametrize("page", pages.PAGES)
def test_every_block_has_its_place_and_every_place_its_block(page):
    document = (ROOT / page).read_text(encoding="utf-8")
    names = [block.name for block in pages.BLOCKS if block.page == page]
    for name in names:
        fill(document, name, "", ROOT / page)
    assert set(re.findall(r"<!-- end ([\w-]+) -->", document)) == {*names, "measured"}


def test_every_block_names_parts():
    known = {part.name for part in parts()}
    assert {name for page in pages.PAGES for name in pages.parts_of(page)} <= known


def test_a_page_says_what_it_was_measured_on():
    record = {name: of() for page in pages.PAGES for name in pages.parts_of(page)}
    whole = "Measured on commit abc1234 (AMD EPYC, 2 cores; 2025-11-30)"
    for page in pages.PAGES:
        assert pages.header(page, record) == f"{whole}."
    record["crowdnav"] = of(date="2025-12-01")
    assert "; 2025-11-30 to 2025-12-01)." in pages.header(pages.README, record)
    record = {"crowdnav_orca": of(), "ladder": of()}  # the first fills no block alone
    others = "All other figures of this page are of earlier commits."
    assert pages.header(pages.PAPER, record) == f"{whole}: `ladder`. {others}"
    assert pages.header(pages.BENCHMARKS, record) == pages.header(pages.README, {}) == EARLIER


def test_blocks_are_written_as_soon_as_their_parts_are_there(tmp_path):
    before = {}
    for page in pages.PAGES:
        (tmp_path / page).parent.mkdir(exist_ok=True)
        before[page] = (ROOT / page).read_text(encoding="utf-8")
        (tmp_path / page).write_text(before[page], encoding="utf-8")
    found = {
        "presets": {"tables": {"presets": "new presets"}},
        "ladder": {"tables": {"ladder": "new ladder"}},
        "barn": {"rows": [{"time": 300.0}], "cpu_s": 10.0},
    }
    record = {name: of() for name in found}
    said, whole = pages.write(tmp_path, found, record)
    after = {page: (tmp_path / page).read_text(encoding="utf-8") for page in pages.PAGES}
    assert between(after[pages.PAPER], "presets") == "new presets"
    picture = "![From print to robot](media/paper/ladder.png)"
    assert between(after[pages.PAPER], "ladder") == f"new ladder\n\n{picture}"
    assert "30 times faster" in between(after[pages.BENCHMARKS], "speed")
    assert "`presets`, `ladder`. All other" in between(after[pages.PAPER], "measured")
    for page, name in (
        (pages.PAPER, "table3"),
        (pages.BENCHMARKS, "targets"),
        (pages.README, "results"),
    ):
        assert between(after[page], name) == between(before[page], name) != ""
    assert between(after[pages.README], "measured") == EARLIER
    assert "missing: scoreboard" in said[-1]
    assert whole
    found["barn"] = {"rows": [{"outcome": "error"}], "cpu_s": 10.0}
    found["presets"] = {"tables": {"presets": "newer presets"}}
    said, whole = pages.write(tmp_path, found, record)
    assert not whole
    assert any("speed is left as it was: KeyError" in line for line in said)
    after = {page: (tmp_path / page).read_text(encoding="utf-8") for page in pages.PAGES}
    assert "30 times faster" in between(after[pages.BENCHMARKS], "speed")
    assert between(after[pages.BENCHMARKS], "measured") == EARLIER
    assert between(after[pages.PAPER], "presets") == "newer presets"


def test_pictures_of_a_part_that_was_measured_elsewhere_stay_as_they_are(tmp_path, monkeypatch):
    monkeypatch.setattr(pages.scoreboard, "DOCS", tmp_path / "docs")
    shown = tmp_path / "docs" / "media" / "paper"
    shown.mkdir(parents=True)
    for name in ("ladder", "ablation"):
        (shown / f"{name}.png").write_text("before")
        (tmp_path / f"{name}.png").write_text("now")
    (tmp_path / "table1.png").write_text("now")
    (tmp_path / "ladder.png").unlink()
    pages.copy_pictures(tmp_path, ["ladder", "table1"])
    assert {file.stem: file.read_text() for file in shown.iterdir()} == {
        "ladder": "before",
        "ablation": "before",
        "table1": "now",
    }


def test_every_part_is_recorded_to_its_end_and_of_one_commit():
    assert set(RECORD) == {part.name for part in parts()}
    assert all(part["complete"] for part in RECORD.values())
    for key in ("commit", "tree"):
        assert len({part[key] for part in RECORD.values()}) == 1


def test_all_pages_name_the_same_commit():
    """Those that `make results` writes, and those whose figures come from other commands."""
    named = {part["commit"] for part in RECORD.values()}
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))):
        named.update(re.findall(r"Measured on commit (\w+)", page.read_text(encoding="utf-8")))
    assert len(named) == 1


@pytest.mark.parametrize("page", pages.PAGES)
def test_the_top_of_a_page_agrees_with_the_record(page):
    document = (ROOT / page).read_text(encoding="utf-8")
    done = {name: part for name, part in RECORD.items() if part["complete"]}
    assert between(document, "measured") == pages.header(page, done)
