"""Parts are measured once for each state of the sources, and one that was cut off goes on."""

import gzip
import json
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import results
from results_parts import parts

NOW, BEFORE = results.Source("now", "abc1234"), results.Source("before", "0123456")
PARTS = {part.name: part for part in parts()}
WRITES = "import sys; open(sys.argv[1], 'w').write('{}')"


@pytest.fixture(autouse=True)
def environment(monkeypatch):
    """The command sets the folder of the data; afterwards it is what it was."""
    monkeypatch.setenv("DYNASTAR_DATA", "")


@pytest.fixture
def runs(monkeypatch):
    """Names of the parts that are run, each by a program that only writes an empty result."""
    ran = []

    def command(part, folder, missions):
        ran.append(part.name)
        fails = part.name == "maps"
        return [sys.executable, "-c", "exit(2)" if fails else WRITES, folder / f"{part.name}.json"]

    monkeypatch.setattr(results, "command_of", command)
    return ran


def test_parts_have_names_of_their_own_and_take_less_than_six_hours():
    assert len(PARTS) == len(parts())
    assert sum(part.minutes for part in parts()) < 360
    assert max(part.minutes for part in parts()) < 150
    assert parts()[-1].name == "ablation"


def test_a_part_is_run_on_worlds_that_are_for_report(tmp_path):
    words = results.command_of(PARTS["office"], tmp_path, None)
    assert words[1:6] == ["-m", "dynastar", "bench", "office", "--missions"]
    assert words[-4:] == ["--seed", "10000", "--json-out", str(tmp_path / "office.json")]
    words = results.command_of(PARTS["table3"], tmp_path, 2)
    assert words[1:5] == ["-m", "dynastar", "paper", "table3"]
    assert words[-4:] == ["--out", str(tmp_path / "paper"), "--maps", "2"]
    assert "--worlds 50 --seed" in " ".join(results.command_of(PARTS["ablation"], tmp_path, None))
    assert results.command_of(PARTS["maps"], tmp_path, 2)[-2:] == ["--missions", "2"]


def test_what_is_done_is_left_out_until_the_sources_change(tmp_path, runs, capsys):
    asked = [PARTS["barn"], PARTS["maps"], PARTS["mrpb"]]
    assert results.measure_all(asked, tmp_path, BEFORE, None) == ["maps"]
    assert runs == ["barn", "maps", "mrpb"]
    assert "3 parts left, about" in capsys.readouterr().out
    assert results.measure_all(asked, tmp_path, BEFORE, None) == ["maps"]
    assert runs[3:] == ["maps"]
    (tmp_path / "barn.json").unlink()
    results.measure_all(asked[::2], tmp_path, BEFORE, None)
    assert runs[4:] == ["barn"]
    results.measure_all(asked[::2], tmp_path, NOW, None)
    assert runs[5:] == ["barn", "mrpb"]
    other = PARTS["barn"]._replace(command=(*PARTS["barn"].command, "--missions", "3"))
    results.measure_all([other], tmp_path, NOW, None)
    assert runs[7:] == ["barn"]
    record = results.read_record(tmp_path)
    assert record["barn"]["commit"] == "abc1234"
    assert record["maps"]["commit"] == "0123456"
    assert not record["maps"]["complete"]


@pytest.mark.parametrize(("sources", "least"), [(NOW, 7.0), (BEFORE, 0.0)])
def test_the_minutes_of_a_part_that_was_cut_off_add_up(tmp_path, runs, sources, least):
    command = " ".join(PARTS["barn"].command)
    begun = {"tree": "now", "command": command, "minutes": 7.0, "complete": False}
    (tmp_path / "record.json").write_text(json.dumps({"barn": begun}))
    assert results.measure(PARTS["barn"], tmp_path, sources, None)
    assert least <= results.read_record(tmp_path)["barn"]["minutes"] < least + 5.0


def test_a_part_that_is_interrupted_is_recorded_as_begun(tmp_path, monkeypatch):
    def interrupted(*words, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(results.subprocess, "run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        results.measure(PARTS["barn"], tmp_path, NOW, None)
    record = results.read_record(tmp_path)
    assert record["barn"]["tree"] == "now"
    assert not results.is_done(PARTS["barn"], record, "now", tmp_path)


@pytest.fixture
def command(tmp_path, monkeypatch, runs):
    """The command in a folder of its own; the pages that it would write are returned."""
    written = []
    monkeypatch.setattr(results, "FOLDER", tmp_path / "results")
    monkeypatch.setattr(results, "KEPT", tmp_path / "kept")
    monkeypatch.setattr(results, "IMPORTED", results.ROOT / "src" / "dynastar")
    monkeypatch.setattr(results, "source", lambda: NOW)
    monkeypatch.setattr(results, "git", lambda *words: "")
    monkeypatch.setattr(results, "missing", lambda: [])
    monkeypatch.setattr(
        results.results_pages, "write", lambda *of: written.append(of[1:]) or ([], True)
    )
    monkeypatch.setattr(results.results_pages, "copy_pictures", lambda *of: None)
    return written


def test_the_pages_are_written_from_the_parts_that_are_done(tmp_path, command):
    assert results.main(["--data", str(tmp_path), "--only", "barn", "maps"]) == 1
    [(found, record)] = command
    assert found == {"barn": {}}
    assert set(record) == {"barn"}


def test_a_trial_is_not_written_into_the_pages(tmp_path, command, runs):
    assert results.main(["--data", str(tmp_path), "--only", "barn", "--missions", "2"]) == 0
    assert runs == ["barn"]
    assert command == []
    assert results.read_record(tmp_path / "results") == results.read_record(tmp_path / "kept") == {}
    with pytest.raises(SystemExit, match="no part was measured"):
        results.main(["--data", str(tmp_path), "--pages"])


def test_another_clone_takes_what_was_kept_of_the_same_sources(
    tmp_path, command, runs, monkeypatch
):
    asked, kept = ["--data", str(tmp_path), "--only"], tmp_path / "kept"
    results.main([*asked, "barn", "maps"])
    assert sorted(file.name for file in kept.iterdir()) == ["barn.json.gz", "record.json"]
    monkeypatch.setattr(results, "FOLDER", tmp_path / "other")
    results.main([*asked, "barn", "mrpb"])
    assert runs == ["barn", "maps", "mrpb"]
    assert command[-1][0] == {"barn": {}, "mrpb": {}}
    first, second = (results.read_record(tmp_path / name) for name in ("results", "other"))
    assert first["barn"] == second["barn"]
    monkeypatch.setattr(results, "source", lambda: BEFORE)
    monkeypatch.setattr(results, "FOLDER", tmp_path / "third")
    results.main([*asked, "mrpb"])
    assert command[-1][0] == {"mrpb": {}}
    assert not (kept / "barn.json.gz").exists()
    assert set(results.read_record(kept)) == {"mrpb"}


def test_another_clone_goes_on_where_a_part_was_cut_off(tmp_path):
    here, kept, there = (tmp_path / name for name in ("here", "kept", "there"))
    begun = {
        part: {"tree": "now", "minutes": 7.0, "complete": False} for part in ("maps", "table3")
    }
    results.results_kept.io.write_json(here / "record.json", begun)
    (here / "paper").mkdir()
    rows = ("maps.json.rows.jsonl", "paper/table3-default.jsonl", "paper/table3-paper.jsonl")
    for name in (*rows, "paper/table1.jsonl"):
        (here / name).write_text(f"/data/here: rows of {name}")
    results.results_kept.keep(here, kept, "now", "/data/here")
    results.results_kept.restore(kept, there, "now", "/there")
    assert results.read_record(there) == begun
    for name in rows:
        assert (there / name).read_text() == f"/there: rows of {name}"
    assert not (there / "paper/table1.jsonl").exists()
    (there / rows[0]).write_text("more rows")
    results.results_kept.restore(kept, there, "now", "/there")
    assert (there / rows[0]).read_text() == "more rows"


def test_what_is_kept_is_the_same_bytes_each_time(tmp_path):
    kept = tmp_path / "kept"
    (tmp_path / "barn.json").write_text('{"rows": [1, 2]}')
    record = {"barn": {"tree": "t", "complete": True}}
    results.results_kept.io.write_json(tmp_path / "record.json", record)
    packed = []
    for _ in range(2):
        results.results_kept.keep(tmp_path, kept, "t", "/data")
        packed.append((kept / "barn.json.gz").read_bytes())
    assert packed[0] == packed[1]
    assert gzip.decompress(packed[0]) == b'{"rows": [1, 2]}'


def test_changed_sources_are_not_measured(tmp_path, command, runs, monkeypatch):
    monkeypatch.setattr(results, "git", lambda *words: " M src/dynastar/path.py")
    with pytest.raises(SystemExit, match="not committed"):
        results.main(["--data", str(tmp_path), "--only", "barn"])
    monkeypatch.setattr(results, "IMPORTED", tmp_path)
    with pytest.raises(SystemExit, match="is imported from"):
        results.main(["--data", str(tmp_path), "--only", "barn"])
    assert runs == []


def test_the_list_says_what_is_done(tmp_path, command, capsys):
    results.main(["--data", str(tmp_path), "--only", "barn"])
    capsys.readouterr()
    results.main(["--list"])
    shown = capsys.readouterr().out.splitlines()
    [barn] = [line for line in shown if line.startswith("barn ")]
    assert "done in 0" in barn
    assert shown[-1].split()[0] == "all"


def test_a_part_whose_packages_are_missing_is_not_begun(tmp_path, command, runs, monkeypatch):
    monkeypatch.setattr(results, "missing", lambda: ["kompass", "physics"])
    with pytest.raises(SystemExit, match=r"\.\[kompass,physics\]"):
        results.main(["--data", str(tmp_path), "--only", "barn"])
    assert runs == []


@pytest.mark.parametrize(
    ("words", "said"), [(["--data", "nowhere"], "--data DIR"), (["--only", "bran"], "bran")]
)
def test_bad_words_are_refused(tmp_path, command, capsys, words, said):
    with pytest.raises(SystemExit):
        results.main(["--data", str(tmp_path), *words])
    assert said in capsys.readouterr().err
