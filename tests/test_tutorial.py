"""The tutorial as typed: an empty folder, an empty home, and nothing but what the page says."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import dynastar

ROOT = Path(__file__).parents[1]
TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"`([\w.]+\.(?:toml|txt))`")
LONG = 300.0  # s; on any machine a block takes less

SESSION = """
import json, sys
names = {"__name__": "__main__"}
for line in sys.stdin:
    exec(json.loads(line), names)
    print("done", file=sys.stderr, flush=True)
"""


class Shell:
    """A folder with an empty home, a shell, and one session of Python."""

    def __init__(self, folder: Path, home: Path) -> None:
        home.mkdir()
        bin_folder = Path(sys.executable).parent
        self.folder = folder
        self.environment = {
            "HOME": str(home),
            "PATH": f"{bin_folder}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(Path(dynastar.__file__).parents[1]),
            # The kernels that this session has compiled: they would take half of the test's time.
            "NUMBA_CACHE_DIR": os.environ["NUMBA_CACHE_DIR"],
            "DYNASTAR_CALLABLE_KERNELS": os.environ["DYNASTAR_CALLABLE_KERNELS"],
        }
        folder.mkdir()
        self.python = subprocess.Popen(
            [sys.executable, "-c", SESSION],
            cwd=folder,
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )

    def type_command(self, line: str) -> None:
        done = subprocess.run(
            ["sh", "-c", line],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=LONG,
        )
        assert done.returncode == 0, f"{line}\n{done.stderr}"

    def type_python(self, text: str) -> None:
        assert self.python.stdin is not None
        assert self.python.stderr is not None
        self.python.stdin.write(json.dumps(text) + "\n")
        self.python.stdin.flush()
        said = []
        for line in self.python.stderr:
            if line == "done\n":
                return
            said.append(line)
        raise AssertionError(f"{text}\n{''.join(said)}")


@pytest.fixture
def shell(tmp_path):
    made = Shell(tmp_path / "empty", tmp_path / "home")
    yield made
    made.python.kill()
    made.python.communicate()


@pytest.mark.slow
def test_the_tutorial_works_as_typed(shell):
    for block in BLOCK.finditer(TUTORIAL):
        kind, text = block.groups()
        if kind == "python":
            shell.type_python(text)
        elif kind == "sh":
            for line in text.splitlines():
                if not line.startswith(("pip ", "git ")):
                    shell.type_command(line)
        else:
            name = FILE.findall(TUTORIAL[: block.start()])[-1]
            (shell.folder / name).write_text(text, encoding="utf-8")
    for name in "a.json", "b.json":
        totals = json.loads((shell.folder / name).read_text(encoding="utf-8"))
        assert (totals["missions"], totals["arrived"]) == (2, 2)
    for picture in "drawing.png", "plan.png", "plan-on-map.png", "episode.png", "my.png":
        assert (shell.folder / picture).stat().st_size > 5000
    assert not (shell.folder / "examples" / "office" / "out").exists()


def test_a_command_or_a_block_that_fails_is_noticed(shell):
    with pytest.raises(AssertionError, match="no_such_file"):
        shell.type_command("dynastar info no_such_file.yaml")
    shell.type_python("found = 1")
    with pytest.raises(AssertionError, match="NameError"):
        shell.type_python("print(not_found)")
