"""Compiling all kernels ahead of time, in processes side by side, and saying so."""

import subprocess
import sys
import time

from dynastar import compiled
from dynastar.terminal import progress_bar

PARTS = "sense_and_plan", "drive"
FILES = 400  # that the cache holds, about, when all is compiled
WAIT = 0.2  # s
WORDS = "compiling kernels, once for this version"


def prepare() -> float:
    """Compiles what the cache lacks of this version; how long that took in s, 0 if it lacked nothing.

    A process that fails is passed over: what it leaves is compiled when it is called.
    """
    mark = compiled.folder() / f"complete-{compiled.digest()}"
    if mark.exists():
        return 0.0
    began = time.perf_counter()
    if not sys.stderr.isatty():
        print(f"{WORDS}: about half a minute on two cores", file=sys.stderr)
    children = [_start(part) for part in PARTS]
    try:
        _wait(children)
    finally:
        for child in children:
            child.kill()
            child.wait()
    if not any(child.returncode for child in children):
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()
    seconds = time.perf_counter() - began
    where = f", into {compiled.folder()}: no home can be written" if compiled.is_temporary() else ""
    print(f"compiled in {seconds:.0f} s{where}", file=sys.stderr)
    return seconds


def _start(part: str) -> "subprocess.Popen[bytes]":
    code = f"from dynastar.cli import compiling; compiling.{part}()"
    quiet = subprocess.DEVNULL
    return subprocess.Popen([sys.executable, "-c", code], stdin=quiet, stdout=quiet, stderr=quiet)


def _wait(children: "list[subprocess.Popen[bytes]]") -> None:
    """Waits for processes, with a bar of the files in the cache."""
    folder = compiled.folder()
    with progress_bar(
        total=FILES,
        desc=WORDS,
        leave=False,
        bar_format="{desc}: {percentage:.0f} % |{bar}| {elapsed}",
    ) as bar:
        while any(child.poll() is None for child in children):
            time.sleep(WAIT)
            bar.n = min(FILES, sum(1 for _ in folder.rglob("*.nb?")))
            bar.refresh()


def sense_and_plan() -> None:
    """Compile the kernels of sensing, then those of the planners that a navigator calls."""
    from dynastar.planning.compiling import warm_up_planning
    from dynastar.simulation.warming import warm_up_sensing

    warm_up_sensing()
    warm_up_planning()


def drive() -> None:
    """Compile the kernels of the dynamic window, and all of a drive that is not compiled by then."""
    from dynastar.simulation import warm_up

    warm_up()
