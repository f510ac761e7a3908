"""Runs a scenario, keeps its episode, reads it back, measures it and draws it."""

import tempfile
from pathlib import Path

import numpy as np

from dynastar import load_episode, load_scenario, run, save_episode
from dynastar.metrics import measure
from dynastar.viewer.figure import draw_episode

folder = Path(tempfile.mkdtemp())
save_episode(run(load_scenario("movers"), seed=7), folder / "movers.npz")

episode = load_episode(folder / "movers.npz")
for name, value in measure(episode)._asdict().items():
    print(f"{name:17} {value}")
nearest = int(np.nanargmin(episode.clearance))
x, y, _ = episode.trajectory.poses[nearest]
print(f"closest at ({x:.2f}, {y:.2f}) m, {episode.trajectory.times[nearest]:.1f} s")
draw_episode(episode, folder / "movers.png")
print(f"drawn into {folder / 'movers.png'}")
