"""Draws what one tick in the office considers, for docs/how-it-drives.md.

python benchmarks/how_it_drives.py [--out docs/media/how-it-drives.png]

The tick is the one with the most samples both admitted and refused while the robot drives forward, and
of several that with the nearest walker.
"""

import argparse
import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from dynastar import Navigator, Twist, load_scenario
from dynastar.perception.prediction import WEIGHTS
from dynastar.robot import arc, slew
from dynastar.simulation.run import drive

ROOT = Path(__file__).parent.parent
OFFICE = ROOT / "examples" / "office" / "office.toml"
NAMES = ("continues", "stops", "turns back")
COLOURS = ("tab:blue", "tab:orange", "tab:red")
NEAR = 0.4  # m
FORWARD = 0.2  # m/s, the least speed at which the chosen sample can be seen
REASONS = ("", "0.6", "tab:red", "tab:purple")  # colours by code of refusal
SCORES = LinearSegmentedColormap.from_list("scores", ["#d55e00", "#0072b2"])  # as on the pages


class Watched(Navigator):
    """A navigator that keeps what its most telling tick considered."""

    best: tuple[tuple[int, float], dict[str, Any]] = ((0, -math.inf), {})

    def retune(self, dwa: Any) -> None:
        """As the navigator's; the scenes of its driving are kept."""
        super().retune(dwa)
        make = self.driving.scene

        def scene(pose: Any, *others: Any) -> Any:
            made = make(pose, *others)
            assert self.driving.guide is not None
            self.seen = made, pose, self.driving.guide.line
            return made

        self.driving.scene = scene  # type: ignore[method-assign]

    def command(self, state: Any, scan: Any, movers: Any = None) -> Twist:
        """Commands as ever, and keeps the tick if it tells more than those before."""
        twist = super().command(state, scan, movers)
        choice = self.status.choice
        walkers = [(t.x, t.y) for t in self.status.tracks if t.state == "confirmed"]
        if choice is None or choice.command is None or not walkers or not self._on_path():
            return twist
        if twist.v < FORWARD:
            return twist
        nearest = min(math.dist(walker, state.pose[:2]) for walker in walkers)
        refused = int((choice.refused > 0).sum())
        telling = min(refused, len(choice.refused) - refused), -nearest
        if telling > Watched.best[0]:
            path = None if self.route.path is None else self.route.path.points
            scene, pose, line = self.seen
            kept = copy.deepcopy((scene, pose, state, line, choice, path))
            Watched.best = telling, {"tick": kept, "robot": self.robot}
        return twist

    def _on_path(self) -> bool:
        """Whether the line that is followed stays near the global path."""
        path, (*_, line) = self.route.path, self.seen
        if path is None:
            return False
        x, y = line[min(len(line) - 1, 20)].tolist()
        return math.dist((x, y), path.at(path.project(x, y))) < NEAR


def draw_scene(axes: Axes, scene: Any, pose: Any, line: Any, path: Any) -> None:
    """The cost-to-go, where it leads, and where moving obstacles are expected."""
    field = scene.cost_to_go.value
    n, a = len(field.values), field.resolution
    extent = (field.x0, field.x0 + n * a, field.y0, field.y0 + n * a)
    value = np.where(np.isfinite(field.values), field.values, np.nan)
    axes.imshow(value, origin="lower", extent=extent, cmap="viridis", alpha=0.6)
    centres = (np.arange(n) + 0.5) * a
    levels = np.arange(np.nanmin(value), np.nanmax(value), 0.25)
    axes.contour(field.x0 + centres, field.y0 + centres, value, levels, colors="w", linewidths=0.4)
    if path is not None:
        axes.plot(*path.T, "m--", lw=1.2, label="global path")
    axes.plot(*line.T, "c-", lw=2.0, label="descent of the cost-to-go")
    draw_obstacles(axes, scene)
    moving = scene.around.moving
    for m, (x, y, vx, vy, radius) in enumerate(moving.obstacles.tolist()):
        for travel, colour in zip(moving.travel[:, 9::10], COLOURS, strict=True):
            for t, deviation in zip(travel, moving.deviation[m, 9::10], strict=True):
                size, place = radius + deviation, (x + t * vx, y + t * vy)
                axes.add_patch(Circle(place, size, fill=False, color=colour, lw=0.8))
    for h, name in enumerate(NAMES):
        axes.plot([], [], color=COLOURS[h], label=f"{name} ({WEIGHTS[h]:g})")
    axes.set_title("Predicted positions every second, grown by one standard deviation", fontsize=10)


def draw_obstacles(axes: Axes, scene: Any) -> None:
    """The moving obstacles where they are."""
    for x, y, _, _, radius in scene.around.moving.obstacles.tolist():
        axes.add_patch(Circle((x, y), radius, color="k", alpha=0.6))


def held(pose: Any, twist: Any, sample: Any, limits: Any) -> list[tuple[float, float]]:
    """Where a robot is every 0.1 s that holds a sample for 1.5 s."""
    points = [pose[:2]]
    for _ in range(15):
        after = Twist(
            slew(twist.v, sample[0], limits.v_accel, limits.v_brake, 0.1),
            slew(twist.omega, sample[1], limits.omega_accel, limits.omega_brake, 0.1),
        )
        mean = Twist(0.5 * (twist.v + after.v), 0.5 * (twist.omega + after.omega))
        pose, twist = arc(pose, mean, 0.1), after
        points.append(pose[:2])
    return points


def draw_choice(axes: Axes, scene: Any, pose: Any, state: Any, choice: Any, robot: Any) -> None:
    """Every sample held for 1.5 s: refused by reason, else by score, the chosen one on top."""
    scores = choice.score[np.isfinite(choice.score)]
    low, high = np.quantile(scores, [0.1, 1.0])
    order = np.argsort(np.where(choice.refused > 0, -np.inf, choice.score))
    for i in order:
        code = int(choice.refused[i])
        style: dict[str, Any] = {"color": REASONS[code], "lw": 0.8, "alpha": 0.7}
        if code == 0:
            share = (choice.score[i] - low) / max(high - low, 1e-9)
            known = np.isfinite(choice.score[i])
            shade = SCORES(min(max(share, 0.0), 1.0)) if known else "tab:pink"
            style = {"color": shade, "lw": 1.2 if known else 0.6}
        if i == order[-1]:
            style = {"color": SCORES(1.0), "lw": 2.5, "zorder": 5}
        points = held(pose, state.twist, choice.samples[i], robot.limits)
        axes.plot(*np.array(points).T, **style)
    words = "no certified stop", "a moving obstacle", "unseen space"
    for code in sorted(set(choice.refused[choice.refused > 0].tolist())):
        axes.plot([], [], color=REASONS[code], label=f"refused: {words[code - 1]}")
    if not np.isfinite(choice.score[choice.refused == 0]).all():
        axes.plot([], [], color="tab:pink", label="admissible, touches an obstacle")
    axes.plot([], [], color=SCORES(0.0), label="admissible, lowest score")
    axes.plot([], [], color=SCORES(1.0), lw=2.5, label="admissible, highest score")
    draw_obstacles(axes, scene)
    axes.set_title("Candidates, held for 1.5 s: refused and scored", fontsize=10)


def main() -> None:
    """Drives across the office and draws the tick."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs/media/how-it-drives.png")
    arguments = parser.parse_args()
    drive(load_scenario(OFFICE), navigator=Watched)
    scene, pose, state, line, choice, path = Watched.best[1]["tick"]
    robot = Watched.best[1]["robot"]
    figure = Figure(figsize=(11, 5.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_scene(left, scene, pose, line, path)
    draw_choice(right, scene, pose, state, choice, robot)
    obstacles = scene.distance_to_obstacle
    n, a = len(obstacles.values), obstacles.resolution
    extent = (obstacles.x0, obstacles.x0 + n * a, obstacles.y0, obstacles.y0 + n * a)
    occupied = np.where(obstacles.values <= 0.0, 1.0, np.nan)
    for axes, half in ((left, 4.0), (right, 1.3)):
        axes.imshow(occupied, origin="lower", extent=extent, cmap="gray", vmin=0, vmax=2)
        size = robot.footprint.inscribed
        axes.add_patch(Circle((pose.x, pose.y), size, fill=False, color="#4a1460", lw=1.8))
        ahead = pose.x + size * math.cos(pose.theta), pose.y + size * math.sin(pose.theta)
        axes.plot([pose.x, ahead[0]], [pose.y, ahead[1]], color="#4a1460", lw=1.8)
        axes.set(xlim=(pose.x - half, pose.x + half), ylim=(pose.y - half, pose.y + half))
        axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
        axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)
    figure.savefig(arguments.out, dpi=90, bbox_inches="tight")
    counts = {name: int(count) for name, count in choice.refusals.items()}
    print(f"{state.stamp:.1f} s: {arguments.out}, refused: {counts}")


if __name__ == "__main__":
    main()
