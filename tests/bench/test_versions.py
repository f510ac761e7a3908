from pathlib import Path

import pytest

import dynastar
from dynastar.bench.versions import version


def test_a_version_is_of_the_library_and_the_modules_named(tmp_path, monkeypatch):
    bench = ("bench/paper.py", "bench/missions.py", "bench/selection.py", "bench/tables.py")
    for name in ("path.py", "dwa/dwa.py", *bench, "cli/run.py"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text("1")
    monkeypatch.setattr(dynastar, "__file__", str(tmp_path / "__init__.py"))

    def changed_by(name, *modules):
        before = version(*modules)
        (tmp_path / name).write_text(f"{before} is no more")
        return version(*modules) != before

    assert changed_by("path.py")
    assert changed_by("dwa/dwa.py", "paper")
    assert changed_by("bench/paper.py", "tables", "paper")
    assert changed_by("bench/selection.py", "paper")
    assert not changed_by("bench/paper.py", "tables")
    assert not changed_by("cli/run.py", "paper")
    assert version("paper", "tables") == version("tables", "paper", "paper") != version("paper")
    with pytest.raises(FileNotFoundError):
        version("nothing")


def test_the_bench_modules_are_found_where_they_are():
    assert (Path(dynastar.__file__).parent / "bench" / "paper.py").is_file()
    assert version("paper") != version()
