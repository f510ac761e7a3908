"""Rows of other code are not taken for these."""

import dynastar
from dynastar.bench.versions import code_version


def test_a_version_is_of_the_library_and_of_bench(tmp_path, monkeypatch):
    for name in ("path.py", "dwa/dwa.py", "bench/suites/people.py", "cli/run.py", "tune/space.py"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True, parents=True)
        file.write_text("1")
    monkeypatch.setattr(dynastar, "__file__", str(tmp_path / "__init__.py"))

    def changed_by(name):
        before = code_version()
        (tmp_path / name).write_text(f"{before} is no more")
        return code_version() != before

    assert changed_by("path.py")
    assert changed_by("dwa/dwa.py")
    assert changed_by("bench/suites/people.py")
    assert not changed_by("cli/run.py")
    assert not changed_by("tune/space.py")
