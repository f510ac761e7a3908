"""Draws field.toml: a field of cylinders that no map has, in the manner of the BARN challenge.

A cellular automaton makes clumps of random cells, smoother with each round; every full cell is a
cylinder. A field is taken if a disc of the robot's size gets through it.
"""

from pathlib import Path

import cv2
import numpy as np

SEED = 3
FILL = 0.2
ROUNDS = 2
CELL, RADIUS = 0.15, 0.075  # m, as in the challenge
ROWS, COLUMNS = 30, 40  # cells: 4.5 m wide, 6 m long
LEFT, LOW = 4.0, 2.75  # m, the field's corner
MAP = 14.0, 10.0  # m
ROBOT = 0.3  # m, radius of a disc that has to get through

HEAD = """\
# A field of cylinders that no map has, in the manner of the BARN challenge; drawn by draw_field.py.

name = "field"
robot = "jackal"
start = [1.5, 5.0, 0.0]
goal = [12.5, 5.0]
latency = 0.1

[map]
resolution = 0.5
rows = [
"""


def field(seed: int) -> np.ndarray:
    """Full cells [rows, columns]: with 5 full neighbours or more a cell fills, with 1 it empties."""
    full = (np.random.default_rng(seed).random((ROWS, COLUMNS)) < FILL).astype(np.uint8)
    for _ in range(ROUNDS):
        padded = np.pad(full, 1)
        around = (
            sum(
                padded[1 + i : 1 + i + ROWS, 1 + j : 1 + j + COLUMNS]
                for i in (-1, 0, 1)
                for j in (-1, 0, 1)
            )
            - full
        )
        full = np.where(around >= 5, 1, np.where(around <= 1, 0, full)).astype(np.uint8)
    return full.astype(bool)


def passable(full: np.ndarray) -> bool:
    """Whether a disc of ``ROBOT`` gets from the left to the right."""
    reach = int(np.ceil((ROBOT + RADIUS) / CELL))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    free = (cv2.dilate(full.astype(np.uint8), disc) == 0).astype(np.uint8)
    _, parts = cv2.connectedComponents(free, connectivity=4)
    return bool(set(parts[:, 0][free[:, 0] > 0]) & set(parts[:, -1][free[:, -1] > 0]))


def main() -> None:
    full = next(one for one in map(field, range(SEED, 1000)) if one.sum() > 60 and passable(one))
    walls = [list("#" * int(2 * MAP[0])) for _ in range(int(2 * MAP[1]))]
    for row in walls[1:-1]:
        row[1:-1] = "." * (len(row) - 2)
    text = HEAD + "".join(f'    "{"".join(row)}",\n' for row in walls) + "]\n"
    for row, column in np.argwhere(full):
        x, y = LEFT + (column + 0.5) * CELL, LOW + (row + 0.5) * CELL
        text += f"\n[[obstacles]]\ndisc = [{x:.3f}, {y:.3f}, {RADIUS}]\n"
    Path(__file__).with_name("field.toml").write_text(text)


if __name__ == "__main__":
    main()
