"""How fast this machine is: ``python benchmarks/calibration.py``.

A fixed amount of arithmetic, compiled, that touches no memory. A time divided by its time can be set
beside one of another machine.
"""

import math
import time

from numba import njit, uint64

STEPS, REPEATS = 1_000_000, 15
BITS, VALUE = 7290476056423008982, 0.7747530296718437  # what it comes to


@njit(cache=True)
def kernel(steps: int) -> tuple[int, float]:
    """A xorshift generator and a recurrence on its numbers; every step waits for the one before."""
    bits, x = uint64(88172645463325252), 0.0
    for _ in range(steps):
        bits ^= bits << uint64(13)
        bits ^= bits >> uint64(7)
        bits ^= bits << uint64(17)
        x = 0.5 * x + float(bits >> uint64(11)) / 9007199254740992.0
    return bits, x


def calibrate() -> float:
    """Milliseconds that the kernel takes, the best of some runs; that all of it was done is asserted."""
    least = math.inf
    for _ in range(REPEATS + 1):  # the first compiles
        began = time.perf_counter()
        bits, x = kernel(STEPS)
        least = min(least, 1e3 * (time.perf_counter() - began))
        assert bits == BITS
        assert math.isclose(x, VALUE)
    return least


if __name__ == "__main__":
    print(f"calibration kernel: {calibrate():.3f} ms")
