import os
import subprocess
import sys
from typing import NamedTuple

import numpy as np
import pytest

from dynastar import compiled
from dynastar.cli import compiling

MAIN = "import sys; from dynastar.cli import main; sys.exit(main(sys.argv[1:]))"
PLAN = "from dynastar.planning import SearchGrid as G; G([[0, 0]]).search((0, 0), (0, 1), 'jump')"

NORM = "from dynastar.planning.segments import norm; norm(3.0, 4.0)"  # a small kernel
NOISE = bytes(range(256))


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


def test_a_kernel_is_not_compiled_once_more_for_a_constant():
    @compiled.njit()
    def called(array, i):
        return array[i]

    @compiled.njit()
    def calling(array, i):
        return called(array, 0) + called(array, 1) + called(array, i=-1) + called(array, i)

    assert calling(np.array([1.0, 2.0, 4.0]), 1) == 9.0
    assert len(called.signatures) == 1


def test_kernels_are_kept_there_even_if_numba_was_imported_before(tmp_path):
    run("import numba; " + NORM, tmp_path)
    assert list((tmp_path / "dynastar").rglob("*.nbi"))


def test_an_empty_cache_folder_is_none(tmp_path):
    code = "import os; os.environ['NUMBA_CACHE_DIR'] = ''; from dynastar import compiled as c; "
    told = run(code + "print(c.folder())", tmp_path).stdout
    assert told.startswith(str(tmp_path / "dynastar"))


def test_the_folder_is_named_after_the_sources_and_where_they_are(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    before = compiled.digest()
    assert compiled.caches() == tmp_path / "dynastar"
    source = tmp_path / "kernels.py"
    source.write_text("from dynastar.compiled import njit\n")
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    alone = compiled.digest()
    source.write_text("from dynastar.compiled import njit  # edited\n")
    edited = compiled.digest()
    other = tmp_path / "other"  # an installation of the same sources
    other.mkdir()
    source.rename(other / "kernels.py")
    monkeypatch.setattr(compiled, "__file__", str(other / "compiled.py"))
    assert len({before, alone, edited, compiled.digest()}) == 4


@pytest.mark.parametrize(
    "text",
    [
        "from dynastar.compiled import inner\n\n@inner\n",
        "from dynastar.compiled import allocating\n\n@allocating\n",
        "class Body(NamedTuple):\n    radius: float\n",
    ],
)
def test_the_folder_changes_with_inner_kernels_and_with_tuples_that_kernels_take(
    text, tmp_path, monkeypatch
):
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    source = tmp_path / "source.py"
    digests = []
    for written in (text, text + "# edited\n", "PLAIN = 1\n", "PLAIN = 2\n"):
        source.write_text(written)
        digests.append(compiled.digest())
    assert len(set(digests[:3])) == 3
    assert digests[2] == digests[3]  # no kernel depends on it


def test_kernels_that_tests_can_call_have_a_folder_of_their_own(tmp_path, monkeypatch):
    told = set()
    for value in ("1", ""):
        monkeypatch.setenv("DYNASTAR_CALLABLE_KERNELS", value)
        told.add(run("from dynastar import compiled as c; print(c.folder())", tmp_path).stdout)
    assert len(told) == 2
    monkeypatch.setattr(compiled, "CALLABLE", not compiled.CALLABLE)
    before = compiled.digest()
    monkeypatch.setattr(compiled, "CALLABLE", not compiled.CALLABLE)
    assert compiled.digest() != before


def as_it_is(values):
    return values


def beside_a_number(values):
    return 1.0, (values, 2.0)


@compiled.njit()
def doubled(values):
    return 2.0 * values


def first_of_doubled(values):
    return doubled(values)[0]


@pytest.mark.parametrize("function", [as_it_is, beside_a_number, first_of_doubled])
def test_an_inner_kernel_that_returns_an_array_or_is_given_one_by_a_kernel_is_refused(function):
    """Nobody would free the array; numba itself refuses inner kernels that make one."""
    compiled.njit()(function)(np.zeros(2))
    with pytest.raises(TypeError, match=f"{function.__name__} returns an array, or calls"):
        compiled.inner(function)(np.zeros(2))


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
    assert "compiling kernels" in capsys.readouterr().err
    assert compiling.prepare() == 0.0
    assert capsys.readouterr().err == ""


def test_what_could_not_be_compiled_is_tried_again(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(compiling, "PARTS", ("no_such_part",))
    assert compiling.prepare() > 0.0
    assert compiling.prepare() > 0.0


def test_without_a_home_that_can_be_written_the_kernels_are_kept_with_temporary_files(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(compiled.tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/none")
    kept = compiled.caches()
    assert kept.parent == tmp_path
    assert kept.stat().st_mode & 0o777 == 0o700
    assert compiled.caches() == kept
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(kept / compiled.digest()))
    monkeypatch.setattr(compiling, "PARTS", ())
    compiling.prepare()
    assert f"into {kept}" in capsys.readouterr().err


def test_a_folder_of_another_user_is_not_trusted(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled.tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/none")
    kept = compiled.caches()
    kept.chmod(0o777)
    other = compiled.caches()
    assert other != kept
    other.rmdir()


def test_damaged_files_in_the_cache_are_compiled_again(tmp_path):
    run(NORM, tmp_path)
    for damaged in (lambda whole: whole[: len(whole) // 2], lambda _: b"", lambda _: NOISE):
        files = sorted((tmp_path / "dynastar").rglob("*.nb?"))
        assert files
        for file in files:
            file.write_bytes(damaged(file.read_bytes()))
        assert run(NORM, tmp_path).stderr == ""


@pytest.mark.slow
def test_the_command_line_works_for_a_user_without_a_name_and_a_home(tmp_path):
    nameless = "import pwd; pwd.getpwuid = lambda number: {}[number]; "
    nameless += "from dynastar.cli import compiling; compiling.PARTS = (); "  # less is compiled
    drawn = tmp_path / "map.txt"
    drawn.write_text("....\n....\n")
    numbers = ["--start", "0.5", "0.5", "--goal", "3.5", "0.5"]
    command = [sys.executable, "-c", nameless + MAIN, "plan", str(drawn), *numbers]
    dropped = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME")
    env = {key: value for key, value in os.environ.items() if key not in dropped}
    env["TMPDIR"] = str(tmp_path)
    for home, compiles in ({"HOME": "/proc/none"}, True), ({}, False):
        done = subprocess.run(command, env=env | home, capture_output=True, text=True)
        assert (done.returncode, done.stdout[:7]) == (0, "planner"), done.stderr
        said = done.stderr.splitlines()
        if compiles:
            assert all(line.startswith("compil") for line in said), done.stderr
            assert "no home can be written" in said[-1]
        else:
            assert said == []


def test_a_record_has_the_fields_of_its_class():
    class Fields(NamedTuple):
        x: float
        number: int
        seen: bool

    dtype = compiled.record(Fields)
    assert dtype.names == Fields._fields
    assert np.array([Fields(0.5, 2, True)], dtype).tolist() == [(0.5, 2, True)]
