import os
import subprocess
import sys

import pytest

from dynastar import compiled
from dynastar.cli import compiling

MAIN = "import sys; from dynastar.cli import main; sys.exit(main(sys.argv[1:]))"
PLAN = "from dynastar.planning import SearchGrid as G; G([[0, 0]]).search((0, 0), (0, 1), 'jump')"


def run(code, cache, *arguments):
    env = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    env["XDG_CACHE_HOME"] = str(cache)
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, env=env, capture_output=True, text=True, check=True)


@pytest.mark.slow
def test_a_program_that_uses_the_library_hears_nothing_of_it(tmp_path):
    own = "import numba; numba.njit(lambda x: x + 1)(1)"
    assert run(f"{PLAN}; {own}", tmp_path).stderr == ""
    assert list((tmp_path / "dynastar").rglob("*.nbi"))
    cleared = run(MAIN, tmp_path, "warmup", "--clear")
    assert "MB deleted" in cleared.stderr
    assert not (tmp_path / "dynastar").exists()


@pytest.mark.slow
def test_kernels_are_kept_there_even_if_numba_was_imported_before(tmp_path):
    run("import numba; " + PLAN, tmp_path)
    assert list((tmp_path / "dynastar").rglob("*.nbi"))


def test_the_folder_is_named_after_the_sources(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    before = compiled.digest()
    assert compiled.caches() == tmp_path / "dynastar"
    source = tmp_path / "kernels.py"
    source.write_text("from dynastar.compiled import njit\n")
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    alone = compiled.digest()
    source.write_text("from dynastar.compiled import njit  # edited\n")
    assert len({before, alone, compiled.digest()}) == 3


def test_importing_dynastar_imports_nothing_heavy():
    code = """
import sys
import dynastar, dynastar.cli
try:
    dynastar.cli.main(["--help"])
except SystemExit:
    pass
heavy = {"numpy", "numba", "matplotlib", "cv2", "shapely", "yaml", "tqdm"} & set(sys.modules)
assert not heavy, heavy
"""
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


def test_the_command_line_says_that_it_compiles_the_first_time_only(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    monkeypatch.setattr(compiling, "PARTS", ())
    assert compiling.prepare() > 0.0
    assert "dynastar compiles its kernels" in capsys.readouterr().err
    assert compiling.prepare() == 0.0
    assert capsys.readouterr().err == ""


def test_what_could_not_be_compiled_is_tried_again(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(compiling, "PARTS", ("no_such_part",))
    assert compiling.prepare() > 0.0
    assert compiling.prepare() > 0.0
