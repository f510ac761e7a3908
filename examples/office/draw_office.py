"""Draws the office of the demo, 40 x 25 m at 5 cm, into office.yaml and office.png beside it."""

from pathlib import Path

import numpy as np

from dynastar import GridFrame, OccupancyGrid, save_map

RESOLUTION = 0.05  # m
WIDTH, HEIGHT = 40.0, 25.0  # m
FREE, OCCUPIED, UNKNOWN = 0, 100, -1

# The building, as rectangles (x0, y0, x1, y1) in metres: what lies outside was never mapped.
FLOORS = [(0.5, 0.5, 39.5, 21.5), (0.5, 13.5, 17.2, 24.5), (24.8, 13.5, 39.5, 24.5)]

# Walls from (x0, y0) to (x1, y1) along their middle, 0.2 m thick.
OUTER = [
    (0.6, 0.6, 39.4, 0.6),
    (39.4, 0.6, 39.4, 24.4),
    (39.4, 24.4, 24.9, 24.4),
    (24.9, 24.4, 24.9, 21.4),
    (24.9, 21.4, 17.1, 21.4),
    (17.1, 21.4, 17.1, 24.4),
    (17.1, 24.4, 0.6, 24.4),
    (0.6, 24.4, 0.6, 0.6),
]
INNER = [
    (0.6, 11.4, 24.9, 11.4),  # the corridor from west to east, 2 m wide
    (27.1, 11.4, 39.4, 11.4),
    (0.6, 13.6, 24.9, 13.6),
    (27.1, 13.6, 39.4, 13.6),
    (24.9, 0.6, 24.9, 11.4),  # the corridor from south to north, 2 m wide
    (27.1, 0.6, 27.1, 11.4),
    (24.9, 13.6, 24.9, 21.4),
    (27.1, 13.6, 27.1, 24.4),
    (8.4, 0.6, 8.4, 11.4),  # between the rooms of the south
    (17.6, 0.6, 17.6, 11.4),
    (17.6, 5.8, 24.9, 5.8),
    (27.1, 6.2, 39.4, 6.2),
    (33.0, 6.2, 33.0, 11.4),
    (8.0, 13.6, 8.0, 24.4),  # between the rooms of the north
    (17.1, 13.6, 17.1, 21.4),
    (33.2, 13.6, 33.2, 24.4),
]

# Doors: (x, y) of the middle and the width, cut through whatever wall is there.
DOORS = [
    (6.2, 11.4, 1.2),  # the start's office: to the corridor and to the open-plan office
    (8.4, 4.0, 1.1),
    (10.2, 11.4, 1.2),  # the open-plan office: to the corridor, twice, and to the store
    (15.8, 11.4, 1.2),
    (17.6, 3.2, 1.1),
    (19.6, 11.4, 1.2),  # the kitchen: to both corridors
    (24.9, 8.4, 1.1),
    (24.9, 3.0, 1.1),  # the store: to the corridor
    (27.1, 3.2, 1.2),  # the workshop
    (27.1, 9.4, 1.1),  # the two small offices, and between them
    (33.0, 8.6, 1.0),
    (36.4, 11.4, 1.1),
    (4.2, 13.6, 1.2),  # the office in the north-west, and to the meeting room
    (8.0, 21.6, 1.1),
    (12.6, 13.6, 1.2),  # the meeting room
    (21.0, 13.6, 1.2),  # the library: to both corridors
    (24.9, 17.6, 1.1),
    (27.1, 19.6, 1.1),  # the office before the goal's: to both corridors and to the goal's
    (29.4, 13.6, 1.2),
    (33.2, 20.6, 1.2),
    (36.2, 13.6, 1.2),  # the goal's office: to the corridor
]

# Furniture: rectangles (x0, y0, x1, y1).
DESKS = [
    *[(x, y, x + 1.6, y + 0.8) for x in (10.0, 13.6) for y in (1.8, 4.6, 7.4)],
    *[(x, y + 0.8, x + 1.6, y + 1.6) for x in (10.0, 13.6) for y in (1.8, 4.6, 7.4)],
    (4.2, 5.6, 5.8, 6.4),
    (0.7, 8.4, 1.5, 10.0),
    (2.0, 16.4, 3.6, 17.2),
    (2.0, 20.4, 3.6, 21.2),
    (5.2, 18.4, 6.8, 19.2),
    (30.6, 8.6, 31.4, 10.2),
    (37.0, 7.2, 38.6, 8.0),
    (29.4, 21.8, 31.0, 22.6),
    (29.0, 16.8, 30.6, 17.6),
    (36.2, 18.0, 37.0, 19.6),
]
SHELVES = [
    (8.5, 8.6, 8.9, 10.6),
    (0.7, 2.8, 1.1, 6.0),
    *[(18.6 + 1.7 * i, 16.2, 19.0 + 1.7 * i, 19.9) for i in range(4)],  # the library's
    (18.4, 0.7, 23.4, 1.2),  # the store's
    (19.4, 3.4, 23.0, 3.9),
    (33.3, 15.0, 33.7, 18.6),
    (38.9, 14.4, 39.3, 17.6),
    (30.0, 0.7, 37.0, 1.3),
]
TABLES = [
    (10.4, 17.4, 14.8, 19.2),  # the meeting table
    (20.4, 7.6, 21.8, 8.8),  # the kitchen's table and its counter
    (17.7, 6.0, 18.3, 10.4),
    (29.8, 2.8, 32.2, 4.0),  # the workshop's benches
    (34.2, 2.8, 36.6, 4.0),
]

# Round things: (x, y, radius). Chairs round the meeting table, pillars, plants.
ROUND = [
    *[(11.0 + 1.1 * i, y, 0.22) for i in range(4) for y in (16.95, 19.65)],
    (12.6, 11.0, 0.2),
    (12.6, 1.2, 0.2),
    (20.2, 9.4, 0.18),
    (22.0, 7.0, 0.18),
    (26.0, 24.0, 0.22),
    (1.1, 12.9, 0.22),
    (38.9, 12.0, 0.22),
    (30.0, 19.4, 0.25),
]


def draw() -> OccupancyGrid:
    """The office as a grid with its lower left corner at (0, 0)."""
    values = np.full((round(HEIGHT / RESOLUTION), round(WIDTH / RESOLUTION)), UNKNOWN, np.int8)

    def fill(x0: float, y0: float, x1: float, y1: float, value: int) -> None:
        rows = slice(round(min(y0, y1) / RESOLUTION), round(max(y0, y1) / RESOLUTION))
        columns = slice(round(min(x0, x1) / RESOLUTION), round(max(x0, x1) / RESOLUTION))
        values[rows, columns] = value

    for floor in FLOORS:
        fill(*floor, FREE)
    for x0, y0, x1, y1 in OUTER + INNER:
        fill(min(x0, x1) - 0.1, min(y0, y1) - 0.1, max(x0, x1) + 0.1, max(y0, y1) + 0.1, OCCUPIED)
    for x, y, width in DOORS:
        along_x = any(y0 == y1 == y and min(x0, x1) < x < max(x0, x1) for x0, y0, x1, y1 in INNER)
        half = (width / 2, 0.1) if along_x else (0.1, width / 2)
        fill(x - half[0], y - half[1], x + half[0], y + half[1], FREE)
    for box in DESKS + SHELVES + TABLES:
        fill(*box, OCCUPIED)
    row, column = np.indices(values.shape)
    x, y = (column + 0.5) * RESOLUTION, (row + 0.5) * RESOLUTION
    for cx, cy, radius in ROUND:
        values[np.hypot(x - cx, y - cy) <= radius] = OCCUPIED
    return OccupancyGrid(values, GridFrame(RESOLUTION))


if __name__ == "__main__":
    folder = Path(__file__).parent
    save_map(draw(), folder / "office.png")
