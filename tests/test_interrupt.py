"""Ctrl-C while a command starts or a kernel returns: one line and status 130."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core import serialize

import dynastar
from dynastar import interrupt

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


RETURNING = """
import os, signal, time
from dynastar.interrupt import interrupt_cleanly
signal.signal(signal.SIGINT, signal.default_int_handler)
interrupt_cleanly()
def _numba_unpickle():
    os.kill(os.getpid(), signal.SIGINT)
    return sum(range(1000))
try:
    print(_numba_unpickle())
    time.sleep(60)
except KeyboardInterrupt:
    print("told")
"""


def test_while_a_kernel_returns_it_comes_a_moment_later():
    done = subprocess.run([sys.executable, "-c", RETURNING], capture_output=True, text=True)
    assert done.stdout == "499500\ntold\n", done.stderr


def test_numba_still_calls_what_is_waited_for():
    assert serialize._numba_unpickle.__name__ == interrupt._BOXING


def test_at_other_times_it_is_a_keyboard_interrupt(tmp_path: Path):
    code = "import os, signal; from dynastar.interrupt import interrupt_cleanly\n"
    code += "signal.signal(signal.SIGINT, signal.default_int_handler); interrupt_cleanly()\n"
    code += "try: os.kill(os.getpid(), signal.SIGINT)\nexcept KeyboardInterrupt: print('told')\n"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "told\n"
