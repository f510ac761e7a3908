"""How long it takes to start: ``dynastar --help`` beside ``python -c pass``."""

import subprocess
import sys
import time
from statistics import median

RUNS = 25
MAIN = "import sys; from dynastar.cli import main; sys.exit(main(['--help']))"
HEAVY = "numpy", "numba", "matplotlib"


def seconds(*command: str) -> float:
    """Median over some runs."""
    took = []
    for _ in range(RUNS):
        began = time.perf_counter()
        subprocess.run(command, capture_output=True, check=True)
        took.append(time.perf_counter() - began)
    return median(took)


def main() -> None:
    """Prints both times and their ratio, and asserts that nothing heavy was imported."""
    timed = subprocess.run(
        [sys.executable, "-X", "importtime", "-c", MAIN], capture_output=True, text=True, check=True
    )
    imported = {line.rsplit("|", 1)[-1].strip() for line in timed.stderr.splitlines()}
    assert not imported & set(HEAVY), imported & set(HEAVY)
    nothing, shown = seconds(sys.executable, "-c", "pass"), seconds(sys.executable, "-c", MAIN)
    print(f"python -c pass {1e3 * nothing:.1f} ms, dynastar --help {1e3 * shown:.1f} ms")
    print(f"ratio {shown / nothing:.1f}")


if __name__ == "__main__":
    main()
