"""How long it takes to start, and in how much memory: ``python benchmarks/startup.py``.

``dynastar --help`` beside ``python -c pass``; importing dynastar and kompass-core, and their first command
with what is compiled already; and compiling all kernels into an empty cache. Median of some runs each;
kernels are compiled once.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from statistics import median

RUNS = 25
FEW = 5
MAIN = "import sys; from dynastar.cli import main; sys.exit(main(['--help']))"
HEAVY = "numpy", "numba", "matplotlib"
CHILD = "import resource; {code}; print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
DRIVE = (
    "import dynastar as d; s = d.load_scenario('office'); w = d.World(s); "
    "n = d.Navigator(s.grid, s.robot); n.set_goal((7.2, 10.0)); n.command(w.sensed_state(), w.scan())"
)
STARTS = (  # the first lines of a program
    ("import dynastar", "import dynastar"),
    ("first command of dynastar, kernels compiled", DRIVE),
    ("import kompass_core's DWA", "from kompass_core.control import DWA"),
)


def seconds(*command: str) -> float:
    """Median over some runs."""
    took = []
    for _ in range(RUNS):
        began = time.perf_counter()
        subprocess.run(command, capture_output=True, check=True)
        took.append(time.perf_counter() - began)
    return median(took)


def started(code: str) -> tuple[float, float]:
    """Seconds, median, and the peak memory (MB) of a new process that runs some code."""
    took, peak = [], 0.0
    command = [sys.executable, "-c", CHILD.format(code=code)]
    for _ in range(FEW + 1):  # the first fills the caches
        began = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        took.append(time.perf_counter() - began)
        peak = int(done.stdout.split()[-1]) / 1024.0
    return median(took[1:]), peak


def compiled() -> tuple[float, float, float]:
    """Wall time and CPU time (s) of compiling all kernels, and the peak memory of a process (MB)."""
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        began = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "dynastar", "warmup"],
            env={**os.environ, "NUMBA_CACHE_DIR": folder},
            capture_output=True,
            check=True,
        )
        wall = time.perf_counter() - began
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return wall, cpu, after.ru_maxrss / 1024.0


def main() -> None:
    """Prints all of it, and asserts that ``--help`` imports nothing heavy."""
    timed = subprocess.run(
        [sys.executable, "-X", "importtime", "-c", MAIN], capture_output=True, text=True, check=True
    )
    imported = {line.rsplit("|", 1)[-1].strip() for line in timed.stderr.splitlines()}
    assert not imported & set(HEAVY), imported & set(HEAVY)
    nothing, shown = seconds(sys.executable, "-c", "pass"), seconds(sys.executable, "-c", MAIN)
    print(f"python -c pass {1e3 * nothing:.1f} ms, dynastar --help {1e3 * shown:.1f} ms")
    print(f"ratio {shown / nothing:.1f}")
    wall, cpu, peak = compiled()
    print(f"compile all kernels: {wall:.1f} s, {cpu:.1f} s of CPU, at most {peak:.0f} MB a process")
    for name, code in STARTS:
        try:
            took, peak = started(code)
        except subprocess.CalledProcessError:
            print(f"{name}: not installed")
            continue
        print(f"{name}: {took:.2f} s, {peak:.0f} MB")


if __name__ == "__main__":
    main()
