"""The pages say what is so: names exist, pictures are there, tables have their places."""

import html
import math
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from dynastar.bench import (
    ablation,
    clutter,
    ladder,
    presets,
    table1,
    table1_tables,
    table3_tables,
    targets,
    terms,
)
from dynastar.bench.table1 import LARGE
from dynastar.bench.tables import as_markdown
from dynastar.cli import main
from dynastar.navigator import NavigatorConfig
from dynastar.planning import ALGORITHMS

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "docs"))
import reference_pages  # noqa: E402

SOURCES = ROOT / "src" / "dynastar"
PAPER = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md"]
PAGES += [*sorted((ROOT / "docs").glob("*.md"))]
PAGES += [
    page for page in sorted((ROOT / "docs").glob("*/*.md")) if page.parent.name != "reference"
]
LESSONS = sorted((ROOT / "docs" / "how-to").glob("*.md"))  # the tutorial: test_tutorial.py

SIMULATORS = {"ir-sim": "irsim", "navground": "navground"}  # pages that need a package


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_to_a_file_leads_to_one(page):
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    for link in links:
        generated = "reference/" in link and link.endswith((".md", ".rst"))
        assert generated or (page.parent / link).exists(), link


def test_each_function_beside_an_equation_is_in_the_file_that_is_named():
    part = PAPER.partition("## Equations")[2].partition("\n\n![")[0]
    part = re.sub(r"\$\$.*?\$\$", "", part, flags=re.DOTALL)
    named = 0
    for names, file in re.findall(r"((?:`\w+`,?\s+)+)in\s+`([\w/]+\.py)`", part):
        text = (ROOT if file.startswith("tests/") else SOURCES).joinpath(file).read_text("utf-8")
        for name in re.findall(r"`(\w+)`", names):
            assert re.search(rf"(def|class) {name}\b", text), f"{name} in {file}"
            named += 1
    assert named > 35


@pytest.mark.parametrize("page", ["architecture.md", "how-it-drives.md"])
def test_every_module_that_an_explanation_names_exists(page):
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    modules = set(re.findall(r"`([\w/]+\.py)`", text))
    assert len(modules) > 15
    for module in modules:
        assert any(SOURCES.rglob(module)) or (ROOT / module).exists(), module


def settings_of(config, prefix=""):
    """Full name of every setting of a table, those of nested tables included."""
    for name, value in config._asdict().items():
        if hasattr(value, "_asdict"):
            yield from settings_of(value, f"{prefix}{name}.")
        else:
            yield prefix + name


def test_the_guide_to_tuning_names_every_setting():
    page = (ROOT / "docs" / "how-to" / "tune.md").read_text(encoding="utf-8")
    table = page.partition("## Every setting")[2] + page.partition("## Trade")[0]
    named = set()
    for cell in re.findall(r"^\| (`[^|]+) \|", table, re.MULTILINE):
        first, *others = re.findall(r"`([\w.]+)`", cell)
        parent = first.rpartition(".")[0]
        named |= {first, *others, *(f"{parent}.{other}" for other in others)}
    assert set(settings_of(NavigatorConfig())) <= named


def test_every_table_of_the_experiments_has_its_place_on_the_page():
    names = set(re.findall(r"<!-- (?!end )([\w-]+) -->", PAPER))
    row = table1.own_row()
    made = table1_tables.tables([{**row, "kind": "random"}], row, [row])
    assert f"table1-{LARGE}" in {table.name for table in made}
    assert {table.name for table in made} < names
    assert names == {table.name for table in made} | {
        "presets",
        "table3-own",
        "table3",
        "table3-presets",
        "table3-driving",
        "clutter",
        "walker",
        "ladder",
        "ablation-paper",
        "ablation-people",
        "terms",
        "terms-cells",
        "terms-time",
        "targets",
        "measured",
    }
    for module, name in (
        (table3_tables, "table3"),
        (clutter, "clutter"),
        (ladder, "ladder"),
        (terms, "terms"),
        (targets, "targets"),
    ):
        assert f'"{name}"' in Path(module.__file__).read_text(encoding="utf-8")


def test_the_table_of_presets_is_of_today():
    assert as_markdown(presets.table()) in PAPER


def test_every_line_of_the_ablation_that_the_page_names_is_one():
    lines = set(ablation.ARMS)
    part = PAPER.partition("## What the paper leaves open")[2].partition("## Table I")[0]
    for row in re.findall(r"\|([^|\n]*)\|\n", part):
        name = row.strip()
        if name.startswith(("Eq. 2", "Eq. 9", "printed", "window", "no re")):
            assert name in lines, name


@pytest.mark.slow
@pytest.mark.parametrize("page", LESSONS, ids=lambda page: page.stem)
def test_every_block_of_a_lesson_works_in_the_order_of_the_page(page, tmp_path, monkeypatch):
    """Runs the commands and the Python of a page, and writes the files that it names."""
    if page.stem in SIMULATORS:
        pytest.importorskip(SIMULATORS[page.stem], reason=f"needs the package of {page.name}")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "lesson"}
    source = page.read_text("utf-8")
    for block in re.finditer(r"^```(\w+)\n(.*?)^```", source, re.DOTALL | re.MULTILINE):
        kind, text = block.groups()
        if kind == "python":
            exec(compile(text, str(page), "exec"), names)
        elif kind == "sh":
            for line in text.splitlines():
                program, *words = shlex.split(line)
                assert (program, main(words)) == ("dynastar", 0), line
        else:
            file = re.findall(r"`([\w.]+\.(?:toml|txt|yaml))`", source[: block.start()])[-1]
            (tmp_path / file).write_text(text)


@pytest.mark.slow
def test_the_documentation_is_built_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
    done = subprocess.run(
        [*command, ROOT / "docs", tmp_path / "site"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    for page in ("index", "tutorial", "reference/settings", "reference/python", "paper"):
        text = (tmp_path / "site" / f"{page}.html").read_text("utf-8")
        outside = re.findall(r'(?:src|rel="stylesheet" href)="(https?://[^"]*)"', text)
        assert not outside, f"{page} loads {outside[:3]} from the network"
        words = html.unescape(re.sub(r"<[^>]+>", "", text))
        for dump in ("Alias for field", "Annotated[", "Field(doc=", "_Buffer", "<factory"):
            assert dump not in words, page


@pytest.mark.parametrize("page", ["settings", "scenario"])
def test_every_setting_and_every_key_has_a_meaning_and_no_odd_words(page):
    text = getattr(reference_pages, page)()
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| `")]
    assert len(rows) > 50
    for row in rows:
        key, kind, _unit, _range, _default, meaning = row
        assert kind.strip(), key
        assert len(meaning.removesuffix("|").strip()) > 3, key
    assert "valuess" not in text
    assert "e+18" not in text


def test_the_settings_page_shows_the_navigators_own_defaults():
    [row] = re.findall(r"^\| `exact` .*", reference_pages.settings(), re.MULTILINE)
    assert f"`{str(NavigatorConfig().planner.exact).lower()}`" in row


def test_the_python_page_has_a_table_for_settings_and_all_planners():
    text = reference_pages.python()
    for words in ("deceleration", "m/s2", "``v_brake``", *ALGORITHMS, "animate_episode"):
        assert words in text, words
    assert "Settings of one dynamic window." in text
    assert repr(2 * math.pi) not in text + reference_pages.scenario()
    assert ".. autofunction:: dynastar.warm_up" in text
