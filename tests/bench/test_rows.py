import json

from dynastar.bench.rows import collect, drop_rows

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


def test_a_file_of_another_run_is_kept_and_taken_up_again(tmp_path, capsys):
    file, old = tmp_path / "rows.jsonl", tmp_path / "rows.jsonl.old"
    jobs, other = [("a", n) for n in range(4)], {**SETTINGS, "seed": 1}
    made(file, jobs)
    first = file.read_bytes()
    assert made(file, jobs[:2], other) == 2
    assert old.read_bytes() == first
    assert capsys.readouterr().err == f"{file} was of another run: it is now {old}\n"
    second = file.read_bytes()
    assert made(file, jobs) == 0
    assert (file.read_bytes(), old.read_bytes()) == (first, second)
    file.unlink()
    assert made(file, jobs, other) == 2
    file.write_text("notes\n")
    made(file, jobs)
    assert old.read_text() == "notes\n"
    assert {path.name for path in tmp_path.iterdir()} == {file.name, old.name}


def test_a_line_that_is_nested_too_deeply_is_made_again(tmp_path):
    file = tmp_path / "rows.jsonl"
    jobs = [("a", n) for n in range(2)]
    made(file, jobs)
    lines = file.read_text().splitlines(keepends=True)
    for depth in (990, 100_000):
        deep = depth * "[" + depth * "]"
        file.write_text(lines[0] + lines[1] + f'{{"job": ["a", 1], "row": {{"x": {deep}}}}}\n')
        assert made(file, jobs) == 1


def test_rows_that_are_dropped_are_made_again(tmp_path):
    file = tmp_path / "rows.jsonl"
    jobs = [("a", n) for n in range(4)]
    drop_rows(file, SETTINGS, jobs, lambda row: True)
    assert not file.exists()
    made(file, jobs)
    drop_rows(file, SETTINGS, jobs, lambda row: row["square"] > 3)
    assert made(file, jobs) == 2
    drop_rows(file, SETTINGS, jobs[:1], lambda row: True)
    assert made(file, jobs) == 1
    before = file.read_bytes()
    drop_rows(file, {**SETTINGS, "seed": 1}, jobs, lambda row: True)
    assert file.read_bytes() == before
