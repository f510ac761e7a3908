"""How the cost grows: ``python benchmarks/growth.py [--out docs/media/growth.png]``.

Four questions, each a table and a panel, log-log with the slope of every line (1: in proportion), the
last one linear: a search of a prepared grid over the side of its map, the dynamic window over its
samples, sensing (scan to distance field, tracker included) over the beams, and sensing and window over
the movers, which walk about the robot and are tracked. Warm, one thread; median and 99th percentile: of
searches over five queries and some repeats, of the others over the ticks.
"""

import argparse
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import matplotlib
import numpy as np
from maps import Cell, queries, random_cells, rooms

from dynastar import (
    ROBOTS,
    Goal,
    Lidar,
    Navigator,
    NavigatorConfig,
    OccupancyGrid,
    Pose2D,
    RobotState,
)
from dynastar.dwa import DwaConfig
from dynastar.geometry import Twist
from dynastar.planning import SearchGrid
from dynastar.simulation.lidar import LidarSimulator
from dynastar.simulation.warming import warm_up

Times = list[float]  # ms
Series = dict[str, list[tuple[float, float, float]]]  # by line: x, median and 99th percentile (ms)
SIDES = 128, 256, 512, 1024, 2048, 4096
SAMPLES = 100, 200, 400, 800, 1600, 3200, 6400
BEAMS = 90, 180, 360, 720, 1440, 2880
MOVERS = 0, 1, 2, 4, 8, 16
HALL, CENTRE, PERIOD, RING = 12.0, Pose2D(6.0, 6.0), 0.1, 3.0  # m, s
TICKS, REPEATS = 150, 5


def timed(run: Callable[[], object], repeats: int) -> Times:
    """Milliseconds of some runs after a first one."""
    took = []
    for _ in range(repeats + 1):
        began = time.perf_counter()
        run()
        took.append(1e3 * (time.perf_counter() - began))
    return took[1:]


def point(x: float, took: Times) -> tuple[float, float, float]:
    """A point of a line."""
    return x, float(np.median(took)), float(np.percentile(took, 99.0))


def searches() -> Series:
    """Over five queries, by algorithm and kind of map, over the side in cells."""
    series: Series = {}
    for n in SIDES:
        for kind, occupied in (("random", random_cells(n, 0.2, 0)), ("rooms", rooms(n, 33, 0))):
            grid, asked = SearchGrid(occupied), queries(occupied, 5, 0)
            for algorithm in ("astar", "auto", "improved"):

                def ask(
                    query: tuple[Cell, Cell], by: str = algorithm, grid: SearchGrid = grid
                ) -> None:
                    grid.forget()  # every search finds its way from nothing
                    grid.search(*query, by)

                took = [ms for q in asked for ms in timed(lambda q=q, ask=ask: ask(q), REPEATS)]
                series.setdefault(f"{algorithm}, {kind}", []).append(point(n, took))
    return series


class Bench:
    """A robot amid a hall that others walk about in, and what its tick does there, step by step."""

    def __init__(self, beams: int = 720, samples: int = 400, movers: int = 0) -> None:
        count = round(math.sqrt(samples))
        dwa = DwaConfig(v_samples=count, omega_samples=round(samples / count))
        config = NavigatorConfig(period=PERIOD, dwa=dwa, stuck_time=120.0)
        occupied = np.zeros((round(HALL / 0.05),) * 2, bool)
        occupied[[0, -1]] = occupied[:, [0, -1]] = True
        grid = OccupancyGrid.from_occupied(occupied, 0.05)
        self.lidar = LidarSimulator(Lidar(beams, math.tau, 0.05, 12.0), grid)
        self.navigator = Navigator(grid, ROBOTS["pioneer3dx"], config)
        self.navigator.set_goal(Goal(HALL - 1.0, CENTRE.y))
        self.movers, self.now = movers, 0.0
        self.took: dict[str, float] = {}
        self._time(self.navigator.sensing, "update")
        self._time(self.navigator.driving.window, "choose")

    def tick(self) -> tuple[float, float]:
        """Milliseconds of the next tick: from the scan to the distance field, and of the choice."""
        self.now += PERIOD
        at = 0.2 * self.now + np.arange(self.movers) * math.tau / max(self.movers, 1)
        x, y = CENTRE.x + RING * np.cos(at), CENTRE.y + RING * np.sin(at)
        discs = np.column_stack([x, y, np.full(len(at), 0.2)])
        scan = self.lidar.scan(CENTRE, self.now, discs)
        self.took.clear()
        self.navigator.command(RobotState(self.now, CENTRE, Twist(0.3, 0.0)), scan)
        return self.took["update"], self.took["choose"]

    def settled(self) -> tuple[Times, Times]:
        """Milliseconds of sensing and of the choice in many ticks, once every mover is tracked."""
        for _ in range(20):
            self.tick()
        took = []
        for _ in range(TICKS):
            took.append(self.tick())
            tracks = len(self.navigator.status.tracks)
            assert tracks == self.movers, (tracks, self.movers)
        sensed, chosen = zip(*took, strict=True)
        return list(sensed), list(chosen)

    def _time(self, part: object, name: str) -> None:
        """Puts a clock at the door of a method of the navigator's."""
        method = getattr(part, name)

        def timed(*arguments: Any) -> Any:
            began = time.perf_counter()
            result = method(*arguments)
            self.took[name] = 1e3 * (time.perf_counter() - began)
            return result

        setattr(part, name, timed)


def window() -> Series:
    """The choice over the number of samples."""
    line = []
    for samples in SAMPLES:
        bench = Bench(samples=samples)
        _, chosen = bench.settled()
        choice = bench.navigator.status.choice
        assert choice is not None
        line.append(point(len(choice.samples), chosen))
    return {"window": line}


def sensing() -> Series:
    """Sensing over the number of beams."""
    return {"sensing": [point(beams, Bench(beams=beams).settled()[0]) for beams in BEAMS]}


def company() -> Series:
    """Sensing and the choice over the number of movers tracked."""
    took = [(movers, *Bench(movers=movers).settled()) for movers in MOVERS]
    return {
        "sensing": [point(movers, sensed) for movers, sensed, _ in took],
        "window, 400 samples": [point(movers, chosen) for movers, _, chosen in took],
    }


def growth(line: list[tuple[float, float, float]], of: int = 1) -> str:
    """The slope of a log-log plot, by least squares; where x starts at 0, what one more of it takes.

    ``of`` is 1 for the medians, 2 for the 99th percentiles.
    """
    x, y = np.array(line)[:, [0, of]].T
    if x[0] == 0:
        return f"{1e3 * float(np.polyfit(x, y, 1)[0]):+.0f} us each"
    return f"slope {float(np.polyfit(np.log(x), np.log(y), 1)[0]):.2f}"


def draw(panels: list[tuple[str, str, Series]], out: Path) -> None:
    """The figure."""
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import LogLocator

    figure, axes = plt.subplots(2, 2, figsize=(10, 7.5), layout="constrained")
    colours = {"astar": "C0", "auto": "C2", "improved": "C1"}
    for axis, (title, unit, series) in zip(axes.flat, panels, strict=True):
        for name, line in series.items():
            algorithm = name.split(",")[0]
            kind: dict[str, Any] = {"color": colours.get(algorithm)}
            if algorithm == "astar":  # auto may lie upon it
                kind |= {"linewidth": 3.5, "markersize": 9}
            if "rooms" in name:
                kind |= {"linestyle": "--", "markerfacecolor": "white"}
            x, median, p99 = zip(*line, strict=True)
            drawn = axis.plot(x, median, marker="o", label=f"{name}: {growth(line)}", **kind)
            axis.plot(x, p99, ":", color=drawn[0].get_color(), linewidth=1.0)
        ticks = [x for x, *_ in next(iter(series.values()))]
        few = len(series) < 3
        if 0 not in ticks:
            axis.set(xscale="log", yscale="log")
            axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if few else (1.0,)))
            axis.yaxis.set_major_formatter("{x:g}")
        if few:
            most = max(p99 for line in series.values() for *_, p99 in line)
            axis.set_ylim(0.0 if 0 in ticks else 0.1, 1.2 * most)
        axis.set_xticks(ticks, [f"{x:g}" for x in ticks])
        axis.minorticks_off()
        axis.set(title=title, xlabel=unit, ylabel="time, ms")
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small")
    figure.savefig(out, dpi=100)


def main() -> None:
    """Measures, prints the tables and draws."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("docs/media/growth.png"))
    out = parser.parse_args().out
    cv2.setNumThreads(1)
    warm_up()
    panels = [
        ("Search of a prepared grid", "side of the map, cells", searches()),
        ("Dynamic window", "samples", window()),
        ("Scan to distance field, local map of 10 m at 5 cm", "beams", sensing()),
        ("With moving obstacles, 720 beams", "obstacles tracked", company()),
    ]
    for title, unit, series in panels:
        ticks = [x for x, *_ in next(iter(series.values()))]
        print(f"\n{title + ', ms':46}" + "".join(f"{x:>9g}" for x in ticks) + f"   over {unit}")
        for name, line in series.items():
            for of, what in ((1, "median"), (2, "p99")):
                cells = "".join(f"{values[of]:9.3f}" for values in line)
                print(f"{name + ', ' + what:46}{cells}   {growth(line, of)}")
    draw(panels, out)


if __name__ == "__main__":
    main()
