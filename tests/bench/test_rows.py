import json
from pathlib import Path

import pytest

import dynastar
from dynastar.bench.rows import collect, version

SETTINGS = {"table": 1, "seed": 0}
calls = []


def square(job):
    calls.append(job)
    return {"square": job[1] ** 2}


def made(file, jobs, settings=SETTINGS):
    calls.clear()
    rows = collect("test", square, jobs, file, settings)
    assert [row["square"] for row in rows] == [job[1] ** 2 for job in jobs]
    return len(calls)


def test_what_is_done_is_not_done_again(tmp_path):
    file = tmp_path / "deep" / "rows.jsonl"
    jobs = [("a", n) for n in range(6)]
    assert made(file, jobs[:4]) == 4
    assert made(file, jobs) == 2
    assert made(file, jobs[::-1]) == 0
    assert made(file, jobs, {**SETTINGS, "seed": 1}) == 6


def test_a_line_that_was_cut_off_is_made_again(tmp_path):
    file = tmp_path / "rows.jsonl"
    jobs = [("a", n) for n in range(4)]
    made(file, jobs)
    text = file.read_text()
    file.write_text(text[:-9])
    assert made(file, jobs) == 1
    assert file.read_text() == text
    lines = text.splitlines(keepends=True)
    file.write_text(
        "".join([*lines[:2], lines[2][:-5] + "\n", '{"job": ["a", 2], "row": null}\n', *lines[4:]])
    )
    assert made(file, jobs) == 2
    file.write_text("no JSON\n" + text)
    assert made(file, jobs) == 4
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    assert lines[0] == SETTINGS
    assert len(lines) == 5


def test_a_version_is_of_the_library_and_the_modules_named(tmp_path, monkeypatch):
    bench = ("bench/paper.py", "bench/runner.py", "bench/tables.py")
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
    assert changed_by("bench/runner.py", "paper")
    assert not changed_by("bench/paper.py", "tables")
    assert not changed_by("cli/run.py", "paper")
    assert version("paper", "tables") == version("tables", "paper", "paper") != version("paper")
    with pytest.raises(FileNotFoundError):
        version("nothing")


def test_the_bench_modules_are_found_where_they_are():
    assert (Path(dynastar.__file__).parent / "bench" / "paper.py").is_file()
    assert version("paper") != version()
