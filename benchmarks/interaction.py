"""Whether people are predicted better if they avoid each other, on recordings; for docs/prediction.md.

python benchmarks/interaction.py --data DIR

Everybody who is there goes on from a moment: straight, or by ORCA [vandenBerg2011] with the present
velocity as the preferred one. Pedestrians with an even number fit a Gaussian of each prediction's errors,
those with an odd one are judged by it: likelihood (nats a person) and errors (m). Needs the extra
``crowdnav``.
"""

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyrvo
from prediction import LEAST_SPEED, RECORDINGS, SPAN

from dynastar.io.pedestrians import load_recording

Floats = npt.NDArray[np.float64]

AHEAD = 1.0, 2.0, 4.0  # s
EVERY = 2.0  # s between two moments
STEP = 0.1  # s
RADIUS = 0.25  # m
HORIZONS = 1.0, 2.0, 4.0  # s that ORCA looks ahead
AROUND, MOST = 5.0, 12  # m and people whom each regards


def present(tracks: list[Floats], time: float) -> tuple[Floats, Floats, npt.NDArray[np.int64]]:
    """Places, velocities (n, 2) and numbers of those who have been there for ``SPAN``."""
    numbers = [k for k, t in enumerate(tracks) if t[0, 0] + SPAN <= time <= t[-1, 0]]
    now, before = (
        np.array([at(tracks[k], time - shift) for k in numbers]).reshape(-1, 2)
        for shift in (0.0, SPAN)
    )
    return now, (now - before) / SPAN, np.array(numbers, np.int64)


def at(track: Floats, time: float) -> tuple[float, float]:
    """The place of a track at a time."""
    x, y = (float(np.interp(time, track[:, 0], track[:, k])) for k in (1, 2))
    return x, y


def by_orca(places: Floats, velocities: Floats, horizon: float) -> dict[float, Floats]:
    """Where everybody is at each of ``AHEAD``."""
    simulator = pyrvo.RVOSimulator(STEP, AROUND, MOST, horizon, horizon, RADIUS, 2.0)
    speeds = np.hypot(*velocities.T)
    for k, place in enumerate(places):
        look = AROUND, MOST, horizon, horizon, RADIUS, float(max(1.3 * speeds[k], 0.1))
        simulator.add_agent(tuple(map(float, place)), *look)
        wanted = tuple(map(float, velocities[k]))
        simulator.set_agent_velocity(k, wanted)
        simulator.set_agent_pref_velocity(k, wanted)
    found = {}
    for step in range(1, round(max(AHEAD) / STEP) + 1):
        simulator.do_step()
        if round(step * STEP, 6) in AHEAD:
            found[round(step * STEP, 6)] = np.array(
                [simulator.get_agent_position(k).to_tuple() for k in range(len(places))]
            )
    return found


def errors(tracks: list[Floats]) -> dict[tuple[str, float], list[Floats]]:
    """Errors (m) and numbers by prediction and seconds ahead, of those who walk: arrays (n, 2)."""
    found: dict[tuple[str, float], list[Floats]] = {}
    begin, end = min(t[0, 0] for t in tracks), max(t[-1, 0] for t in tracks)
    for time in np.arange(begin + SPAN, end - min(AHEAD), EVERY):
        places, velocities, numbers = present(tracks, float(time))
        if not len(numbers):
            continue
        predicted = {"straight": {ahead: places + ahead * velocities for ahead in AHEAD}}
        predicted |= {f"ORCA, {h:g} s": by_orca(places, velocities, h) for h in HORIZONS}
        walks = np.hypot(*velocities.T) >= LEAST_SPEED
        for name, by_time in predicted.items():
            for ahead, then in by_time.items():
                stays = np.array([time + ahead <= tracks[k][-1, 0] for k in numbers])
                for i in np.flatnonzero(walks & stays):
                    away = np.hypot(*(then[i] - at(tracks[numbers[i]], float(time + ahead))))
                    found.setdefault((name, ahead), []).append(np.array([away, numbers[i]]))
    return found


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True)
    given = parser.parse_args()
    everything: dict[tuple[str, float], list[Floats]] = {}
    for name in RECORDINGS:
        tracks = list(load_recording(given.data / "pedestrians" / f"{name}.csv").tracks)
        for key, rows in errors(tracks).items():
            everything.setdefault(key, []).append(np.array(rows))
    print("| s ahead | prediction | people | likelihood, nats | 50 %, m | 90 %, m |")
    print("|--:|:--|--:|--:|--:|--:|")
    for ahead in AHEAD:
        for name in dict.fromkeys(key[0] for key in everything):
            away, number = np.concatenate(everything[name, ahead]).T
            fit, check = away[number % 2 == 0], away[number % 2 == 1]
            variance = 0.5 * float(np.mean(fit**2))
            nats = -np.log(2.0 * np.pi * variance) - 0.5 * np.mean(check**2) / variance
            middle, most = np.quantile(check, (0.5, 0.9))
            print(f"| {ahead:g} | {name} | {len(check)} | {nats:.3f} | {middle:.2f} | {most:.2f} |")


if __name__ == "__main__":
    main()
