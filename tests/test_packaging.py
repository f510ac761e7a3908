"""What is installed: examples come with it, and what only some uses need is asked for in a sentence."""

import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from dynastar.cli import main
from dynastar.errors import MissingPackage
from dynastar.extras import PUBLISHED, install_command
from dynastar.io.examples import examples_folder
from dynastar.page.report import SCRIPTS

ROOT = Path(__file__).parents[1]

SCENARIO = """
name = "a room"
robot = "pioneer3dx"
start = [1.0, 1.0, 0.0]
goals = [[3.0, 1.0]]
[map]
resolution = 1.0
rows = ["....", "...."]
"""

WITHOUT = "import sys; sys.modules.update(dict.fromkeys(sys.argv[1].split(','))); "
MAIN = "from dynastar.cli import main; sys.exit(main(sys.argv[2:]))"


def without(packages, *words, cwd):
    """The command line in a process of its own that cannot import some packages."""
    command = [sys.executable, "-c", WITHOUT + MAIN, packages, *words]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def test_examples_are_listed_and_copied(tmp_path, capsys):
    assert main(["demo", "--list"]) == 0
    assert "office" in capsys.readouterr().out.split()
    folder = tmp_path / "mine"
    assert main(["demo", "--copy", str(folder)]) == 0
    assert (folder / "office" / "office.toml").is_file()
    assert (folder / "01_plan.py").is_file()
    capsys.readouterr()
    assert main(["demo", "--copy", str(folder)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert main(["demo", "offce"]) == 2
    assert "did you mean 'office'" in capsys.readouterr().err


@pytest.mark.slow
def test_the_wheel_has_the_examples(tmp_path):
    words = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(tmp_path), str(ROOT)]
    subprocess.run([sys.executable, *words], check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        inside = archive.namelist()
        archive.extractall(tmp_path / "installed")
    for file in examples_folder().rglob("*.toml"):
        assert f"dynastar/examples/{file.relative_to(examples_folder())}" in inside
    for name in ("page.html", "play.html", "page.css", "play.js", *SCRIPTS):
        assert f"dynastar/page/static/{name}" in inside
    assert not [name for name in inside if "__pycache__" in name]
    asked = "import dynastar.io.examples as e; print(e.__file__, *e.example_scenarios().values())"
    found = subprocess.run(
        [sys.executable, "-c", asked],
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path / "installed")},
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    assert found
    assert all(Path(file).is_relative_to(tmp_path / "installed") for file in found)


def test_a_robot_needs_no_matplotlib_and_no_scipy(tmp_path):
    (tmp_path / "room.toml").write_text(SCENARIO)
    ran = without("matplotlib,scipy", "run", "room.toml", "--out", "out", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert "pip install '.[viewer]'" in ran.stderr
    assert (tmp_path / "out" / "episode.npz").is_file()
    assert (tmp_path / "out" / "summary.json").is_file()


@pytest.mark.parametrize("words", [("bench", "paper", "--missions", "1"), ("paper", "presets")])
def test_what_needs_an_extra_says_which(words, tmp_path):
    ran = without("matplotlib,scipy", *words, cwd=tmp_path)
    assert ran.returncode == 2
    (line,) = ran.stderr.splitlines()
    assert "pip install '.[" in line


def test_pictures_from_python_say_it_too():
    code = "import sys; sys.modules['matplotlib'] = None; import dynastar.viewer"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert MissingPackage.__name__ in ran.stderr.splitlines()[-1]


def test_pages_and_messages_install_extras_by_the_command_that_works_today():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "optional-dependencies"
    ]
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    files = [file for name in ("src", "ros", "examples") for file in (ROOT / name).rglob("*")]
    texts = [file for file in files if file.suffix in (".py", ".xml", ".md")]
    found = 0
    for file in [*pages, *(text for text in texts if text.name != "extras.py")]:
        for command, named in re.findall(
            r"(pip install (?:-e )?'[\w.]*\[([\w,]+)\]')", file.read_text("utf-8")
        ):
            assert command.replace("-e ", "") == install_command(named), file
            assert set(named.split(",")) <= set(extras), file
            found += 1
        assert PUBLISHED or "pip install dynastar" not in file.read_text("utf-8"), file
    assert found >= 8
