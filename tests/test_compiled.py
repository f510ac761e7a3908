import os
import subprocess
import sys

import pytest

from dynastar import compiled

MAIN = "import sys; from dynastar.cli import main; sys.exit(main(sys.argv[1:]))"
PLAN = "from dynastar.planning import SearchGrid as G; G([[0, 0]]).search((0, 0), (0, 1), 'jump')"


def run(code, cache, *arguments):
    ours = ("NUMBA_CACHE_DIR", compiled.ANNOUNCE)
    env = {k: v for k, v in os.environ.items() if k not in ours}
    env["XDG_CACHE_HOME"] = str(cache)
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, env=env, capture_output=True, text=True, check=True)


@pytest.mark.slow
def test_the_command_line_says_that_it_compiles_the_first_time_only(tmp_path):
    map_file = tmp_path / "m.map"
    map_file.write_text("type octile\nheight 9\nwidth 9\nmap\n" + 9 * (9 * "." + "\n"))
    plan = ("plan", str(map_file), "--start", "1", "1", "--goal", "7", "5")
    first = run(MAIN, tmp_path, *plan)
    assert first.stderr.count("dynastar compiles its kernels") == 1
    assert "compiles" not in run(MAIN, tmp_path, *plan).stderr
    assert list((tmp_path / "dynastar").rglob("*.nbi"))
    cleared = run(MAIN, tmp_path, "warmup", "--clear")
    assert "MB deleted" in cleared.stderr
    assert not (tmp_path / "dynastar").exists()


@pytest.mark.slow
def test_a_program_that_uses_the_library_hears_nothing_of_it(tmp_path):
    own = "import numba; numba.njit(lambda x: x + 1)(1); "
    assert run(PLAN + "; " + own, tmp_path).stderr == ""
    quiet = run(
        f"import os; os.environ['{compiled.ANNOUNCE}'] = '1'; import dynastar.compiled; {own}",
        tmp_path,
    )
    assert quiet.stderr == ""


@pytest.mark.slow
def test_kernels_are_kept_there_even_if_numba_was_imported_before(tmp_path):
    run("import numba; " + PLAN, tmp_path)
    assert list((tmp_path / "dynastar").rglob("*.nbi"))


def test_the_folder_is_named_after_the_sources(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    before = compiled.cache()
    assert before.parent == tmp_path / "dynastar"
    source = tmp_path / "kernels.py"
    source.write_text("from dynastar.compiled import njit\n")
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    alone = compiled.cache()
    source.write_text("from dynastar.compiled import njit  # edited\n")
    assert len({before, alone, compiled.cache()}) == 3


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
