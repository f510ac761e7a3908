"""Ctrl-C while a command starts: one line and status 130, whatever is being imported."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import dynastar

# A module that is interrupted while it is imported, and makes another error of it.
INTERRUPTED = """
import os, signal
try:
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000): pass
except KeyboardInterrupt:
    raise ImportError("made of an interrupt")
"""


def run(folder: Path, *words: str) -> "subprocess.CompletedProcess[str]":
    found = os.pathsep.join([str(folder), str(Path(dynastar.__file__).parents[1])])
    start = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    start += "from dynastar.__main__ import start; import sys; sys.exit(start())"
    return subprocess.run(
        [sys.executable, "-c", start, *words],
        capture_output=True, text=True, timeout=120, cwd=folder,
        env={**os.environ, "PYTHONPATH": found},
    )  # fmt: skip


@pytest.mark.parametrize("module", ["argparse", "numpy"])
def test_an_interrupt_during_an_import_is_one_line(tmp_path: Path, module: str):
    (tmp_path / f"{module}.py").write_text(INTERRUPTED)
    done = run(tmp_path, "info", "a.toml")
    assert done.stderr == "dynastar: interrupted\n"
    assert done.returncode == 130


def test_at_other_times_it_is_a_keyboard_interrupt(tmp_path: Path):
    code = "import os, signal; from dynastar.interrupt import end_imports_cleanly\n"
    code += "signal.signal(signal.SIGINT, signal.default_int_handler); end_imports_cleanly()\n"
    code += "try: os.kill(os.getpid(), signal.SIGINT)\nexcept KeyboardInterrupt: print('told')\n"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "told\n"
