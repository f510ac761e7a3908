"""The dynamic window: which speeds can be reached (Eqs. 5 and 6), and its samples."""

from dynastar.compiled import njit
from dynastar.dwa.motion import slew


@njit(cache=True)
def dynamic_window(v, omega, limits, v_cap, span):
    """Eqs. 5 and 6: the speeds within the limits that are reached in ``span`` seconds.

    Returns (lowest v, highest v, lowest omega, highest omega); |v| is capped at ``v_cap``.
    """
    slowest, fastest = max(limits.v_min, -v_cap), max(v_cap, limits.v_min)
    low_v = slew(v, slowest, limits.v_accel, limits.v_brake, span)
    high_v = slew(v, fastest, limits.v_accel, limits.v_brake, span)
    low_w = slew(omega, -limits.omega_max, limits.omega_accel, limits.omega_brake, span)
    high_w = slew(omega, limits.omega_max, limits.omega_accel, limits.omega_brake, span)
    return min(low_v, high_v), max(low_v, high_v), min(low_w, high_w), max(low_w, high_w)


@njit(cache=True)
def spaced(low, high, count, values):
    """Writes about ``count`` values from low to high, both among them, and how many; denser round 0.

    Away from zero they grow with the square, so that slow and nearly straight motions can be told
    apart; 0 is one of them where it lies between.
    """
    if high - low < 1e-9:
        values[0] = high
        return 1
    largest = max(abs(low), abs(high))
    half = count // 2
    k = 0
    values[k] = low
    for i in range(-half, half + 1):
        value = largest * i * abs(i) / (half * half)
        if low < value < high:
            k += 1
            values[k] = value
    values[k + 1] = high
    return k + 2


@njit(cache=True)
def cross(count_v, count_w, speeds, rates, samples):
    """Writes each of the speeds with each of the turning rates to ``samples``; returns how many."""
    k = 0
    for i in range(count_v):
        for j in range(count_w):
            samples[k, 0], samples[k, 1] = speeds[i], rates[j]
            k += 1
    return k


@njit(cache=True)
def sample_window(window, speeds, rates, n_v, n_omega, samples):
    """Writes the window's samples (v, omega) to ``samples`` (n, 2) and returns how many there are."""
    count_v = spaced(window[0], window[1], n_v, speeds)
    count_w = spaced(window[2], window[3], n_omega, rates)
    return cross(count_v, count_w, speeds, rates, samples)
