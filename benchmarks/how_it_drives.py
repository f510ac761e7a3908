"""Draws what one tick in the office considers, for docs/how-it-drives.md.

python benchmarks/how_it_drives.py [--out docs/media/how-it-drives.png]

The tick is the one, with somebody walking near, with the most samples both admitted and refused.
"""

import argparse
import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from dynastar import Navigator, Twist, load_scenario
from dynastar.dwa.motion import driven
from dynastar.perception.prediction import SPEEDS, WEIGHTS
from dynastar.simulation.run import drive

ROOT = Path(__file__).parent.parent
OFFICE = ROOT / "examples" / "office" / "office.toml"
NAMES = ("goes on", "stops", "turns back")
COLOURS = ("tab:blue", "tab:orange", "tab:red")
REASONS = ("", "tab:brown", "tab:red", "tab:purple")  # by code of refusal


class Watched(Navigator):
    """A navigator that keeps what its most telling tick considered."""

    best: tuple[int, dict[str, Any]] = (-1, {})

    def _scene(self, state: Any, pose: Any, movers: Any) -> Any:
        self.seen = super()._scene(state, pose, movers), pose
        return self.seen[0]

    def command(self, state: Any, scan: Any, movers: Any = None) -> Twist:
        """Commands as ever, and keeps the tick if it tells more than those before."""
        twist = super().command(state, scan, movers)
        choice = self.status.choice
        if choice is None:
            return twist
        walking = any(track.state == "confirmed" for track in self.status.tracks)
        telling = walking * min((choice.refused == 0).sum(), (choice.refused > 0).sum())
        if telling > Watched.best[0]:
            path = None if self.route.path is None else self.route.path.points
            kept = copy.deepcopy((*self.seen, state, choice, self.guidance.line, path))
            Watched.best = int(telling), {"tick": kept, "robot": self.robot}
        return twist


def draw_scene(axes: Axes, scene: Any, pose: Any, line: Any, path: Any) -> None:
    """The cost-to-go, where it leads, and where moving obstacles are expected."""
    field = scene.cost_to_go
    n, a = len(field.value), field.resolution
    extent = (field.x0, field.x0 + n * a, field.y0, field.y0 + n * a)
    value = np.where(np.isfinite(field.value), field.value, np.nan)
    axes.imshow(value, origin="lower", extent=extent, cmap="viridis", alpha=0.6)
    centres = (np.arange(n) + 0.5) * a
    levels = np.arange(np.nanmin(value), np.nanmax(value), 0.25)
    axes.contour(field.x0 + centres, field.y0 + centres, value, levels, colors="w", linewidths=0.4)
    if path is not None:
        axes.plot(*path.T, "m--", lw=1.2, label="global path")
    axes.plot(*line.T, "c-", lw=2.0, label="descent of the cost-to-go")
    people = scene.people
    for m, person in enumerate(people.now):
        axes.add_patch(Circle(person[:2], person[4], color="k", alpha=0.6))
        for h in range(len(SPEEDS)):
            for k in range(9, people.mean.shape[2], 10):
                size = person[4] + people.spread[k]
                ring = Circle(people.mean[m, h, k], size, fill=False, color=COLOURS[h], lw=0.8)
                axes.add_patch(ring)
    for h, name in enumerate(NAMES):
        axes.plot([], [], color=COLOURS[h], label=f"{name} ({WEIGHTS[h]:g})")
    axes.set_title("Predicted positions every second, grown by one standard deviation", fontsize=10)


def draw_choice(axes: Axes, scene: Any, pose: Any, state: Any, choice: Any, robot: Any) -> None:
    """Every sample held for 1.5 s: refused by reason, else by score, the chosen one on top."""
    scores = choice.score[np.isfinite(choice.score)]
    low, high = np.quantile(scores, [0.1, 1.0])
    order = np.argsort(np.where(choice.refused > 0, -np.inf, choice.score))
    for i in order:
        at = (pose.x, pose.y, math.cos(pose.theta), math.sin(pose.theta))
        v, omega, points = *state.twist, [at[:2]]
        for _ in range(15):
            at, v, omega = driven(at, v, omega, *choice.samples[i], robot.limits, 0.1)
            points.append(at[:2])
        code = int(choice.refused[i])
        style: dict[str, Any] = {"color": REASONS[code], "lw": 0.8, "alpha": 0.7}
        if code == 0:
            share = (choice.score[i] - low) / max(high - low, 1e-9)
            known = np.isfinite(choice.score[i])
            shade = colormaps["summer_r"](min(max(share, 0.0), 1.0)) if known else "0.6"
            style = {"color": shade, "lw": 1.0 if known else 0.6}
        axes.plot(*np.array(points).T, **style)
    axes.plot([], [], color=REASONS[1], label="refused: no certified stop")
    axes.plot([], [], color=REASONS[2], label="refused: a moving obstacle")
    axes.plot([], [], color=REASONS[3], label="refused: unseen space")
    axes.plot([], [], color="0.6", label="admissible, left early")
    axes.plot([], [], color=colormaps["summer_r"](0.9), label="admissible, by its score")
    for person in scene.people.now:
        axes.add_patch(Circle(person[:2], person[4], color="k", alpha=0.6))
    axes.set_title("Refused and scored: samples, held for 1.5 s", fontsize=10)


def main() -> None:
    """Drives across the office and draws the tick."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs/media/how-it-drives.png")
    arguments = parser.parse_args()
    drive(load_scenario(OFFICE), navigator=Watched)
    scene, pose, state, choice, line, path = Watched.best[1]["tick"]
    robot = Watched.best[1]["robot"]
    figure = Figure(figsize=(11, 5.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_scene(left, scene, pose, line, path)
    draw_choice(right, scene, pose, state, choice, robot)
    obstacles = scene.obstacles
    n, a = len(obstacles.distance), obstacles.resolution
    extent = (obstacles.x0, obstacles.x0 + n * a, obstacles.y0, obstacles.y0 + n * a)
    stands = np.where(obstacles.distance <= 0.0, 1.0, np.nan)
    for axes, half in ((left, 4.0), (right, 1.3)):
        axes.imshow(stands, origin="lower", extent=extent, cmap="gray", vmin=0, vmax=2)
        size = robot.footprint.inscribed
        axes.add_patch(Circle((pose.x, pose.y), size, fill=False, color="r", lw=1.5))
        ahead = pose.x + size * math.cos(pose.theta), pose.y + size * math.sin(pose.theta)
        axes.plot([pose.x, ahead[0]], [pose.y, ahead[1]], "r", lw=1.5)
        axes.set(xlim=(pose.x - half, pose.x + half), ylim=(pose.y - half, pose.y + half))
        axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)
    figure.savefig(arguments.out, dpi=90, bbox_inches="tight")
    counts = {name: int(count) for name, count in choice.refusals.items()}
    print(f"{state.stamp:.1f} s: {arguments.out}, refused: {counts}")


if __name__ == "__main__":
    main()
