"""Draws a guarded drive, for docs/how-to/make-any-controller-safe.md.

python benchmarks/guard_picture.py [--out docs/media/guard.png]
"""

import argparse
from pathlib import Path

import numpy as np

from dynastar import Guard, Twist, World, load_scenario
from dynastar.viewer import palette
from dynastar.viewer.layers import show_map
from dynastar.viewer.sheet import PAGE, SMALL, legend_style, plain, room, save, sheet
from dynastar.viewer.view import known_view

ROOT = Path(__file__).parent.parent
HALL = ROOT / "examples" / "features" / "goals.toml"
ASKED = (  # speeds (m/s, rad/s) of a careless driver, each for some seconds
    *((0.55, 0.0, 7.0), (0.55, 0.6, 5.0), (0.55, 0.0, 8.0), (-0.2, 0.0, 3.0), (0.4, -0.7, 4.0)),
    *((0.55, 0.0, 12.0), (0.3, 0.8, 4.0), (0.55, 0.0, 8.0)),
)
PERIOD = 0.05  # s
EVERY = 12  # ticks between two stops that are drawn
PASSED, HELD_BACK = "#009e73", "#e69f00"


def main() -> None:
    """Drives and draws."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs/media/guard.png")
    arguments = parser.parse_args()
    scenario = load_scenario(HALL)
    world, guard = World(scenario), Guard(scenario.robot)
    poses, asked, given, held, stops = [], [], [], [], []
    for v, omega, seconds in ASKED:
        for _ in range(round(seconds / PERIOD)):
            found = guard.filter(world.sensed_state(), world.scan(), Twist(v, omega))
            poses.append(world.pose[:2])
            asked.append(v)
            given.append(found.command.v)
            held.append(found.reason not in ("", "acceleration"))
            stops.append(guard.stop[:, :2])
            world.step(found.command, PERIOD)
    assert not world.contact
    draw(scenario.grid, np.array(poses), (asked, given), np.array(held), stops, arguments.out)
    print(f"{arguments.out}: held back in {np.mean(held):.0%} of the commands, {world}")


def draw(grid, poses, speeds, held, stops, out) -> None:
    """The way with its stops on the map, and the speeds beside each other."""
    figure = sheet(PAGE, 4.6)
    axes = room(figure, 0.5, 1.75, PAGE - 0.6, 2.75)
    show_map(axes, grid, known_view(grid))
    for k in range(0, len(stops), EVERY):
        colour = HELD_BACK if held[k] else PASSED
        axes.plot(*stops[k].T, color=colour, linewidth=4.0, alpha=0.35, solid_capstyle="round")
    axes.plot(*poses.T, color=palette.INK, linewidth=0.8)
    axes.plot(*poses[0], "o", color=palette.INK, markersize=4)
    plain(axes)
    axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    below = room(figure, 0.5, 0.35, PAGE - 0.6, 1.0)
    times = PERIOD * np.arange(len(poses))
    below.plot(
        times, speeds[0], color=palette.FAINT_INK, linewidth=0.8, linestyle="--", label="asked for"
    )
    below.plot(times, speeds[1], color=palette.DRIVEN, linewidth=1.0, label="driven")
    low, high = below.get_ylim()
    below.fill_between(
        times, low, high, where=held, color=HELD_BACK, alpha=0.25, linewidth=0, label="held back"
    )
    below.set(xlim=(0.0, times[-1]), ylim=(low, high), xlabel="time, s", ylabel="v, m/s")
    below.legend(loc="lower left", bbox_to_anchor=(0.0, 1.02), ncols=3, **legend_style(SMALL))
    plain(below)
    save(figure, out)


if __name__ == "__main__":
    main()
