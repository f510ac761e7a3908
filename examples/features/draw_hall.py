"""Draws hall.yaml, and the masks keepout.yaml and speed.yaml over it, with their images."""

from pathlib import Path

import numpy as np

from dynastar import GridFrame, OccupancyGrid
from dynastar.io import save_ros_map

FRAME = GridFrame(0.05)
FOLDER = Path(__file__).parent


def cells(*boxes: tuple[float, float, float, float]) -> np.ndarray:
    """Which cells of 14 x 8 m lie in boxes (x low, y low, x high, y high), metres."""
    y, x = (np.indices((160, 280)) + 0.5) * FRAME.resolution
    inside = [(x >= x0) & (y >= y0) & (x < x1) & (y < y1) for x0, y0, x1, y1 in boxes]
    return np.logical_or.reduce(inside)


def draw() -> dict[str, OccupancyGrid]:
    """The maps by name: 0 free, 100 occupied, -1 unknown; of the speed mask, per cent taken off."""
    hall = np.zeros((160, 280), np.int8)
    hall[~cells((0.2, 0.2, 13.8, 7.8))] = 100
    hall[cells((4.0, 0.2, 4.2, 3.0), (4.0, 4.6, 4.2, 7.8), (9.5, 0.2, 9.7, 1.2))] = 100
    hall[cells((9.5, 2.6, 9.7, 5.6), (9.5, 7.0, 9.7, 7.8), (6.4, 3.4, 7.4, 4.4))] = 100
    hall[cells((9.7, 5.0, 13.8, 7.8))] = -1
    hall[cells((9.5, 5.0, 9.7, 5.6), (9.5, 7.0, 9.7, 7.8))] = 100
    keepout = cells((8.0, 0.2, 9.4, 2.8)) * np.int8(100)
    slow = cells((4.4, 0.2, 6.2, 7.8)) * np.int8(60)
    drawn = {"hall": hall, "keepout": keepout, "speed": slow}
    return {name: OccupancyGrid(values, FRAME) for name, values in drawn.items()}


if __name__ == "__main__":
    for name, grid in draw().items():
        save_ros_map(grid, FOLDER / f"{name}.yaml", image="png")
