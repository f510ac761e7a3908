"""What a metre costs in each cell of the local map: more near obstacles, and where one is met."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.compiled import njit
from dynastar.field import blocks
from dynastar.perception.prediction import WEIGHTS, contact_probability

NEAR_COST = 4.0  # extra cost of a metre right at the margin of an obstacle
ENCOUNTER_COST = 15.0  # extra cost of a metre where a moving obstacle is met for certain
DEVIATIONS = 2.0  # standard deviations from which on a moving obstacle costs nothing


class Encounter(NamedTuple):
    """How the robot would meet moving obstacles: its place (m), speed (m/s) and radius (m).

    It starts when a command acts; predictions are known every ``step`` seconds from then on.
    """

    x: float
    y: float
    speed: float
    radius: float
    step: float


def travel_cost(
    distance: npt.NDArray[np.float32], factor: int, margin: float, comfort: float
) -> npt.NDArray[np.float64]:
    """The cost of a metre in every cell, inf where the robot does not fit.

    ``distance`` holds metres to the nearest obstacle on a grid ``factor`` times as fine; a cell has
    the clearance of the best of its parts. 1 + 4 (1 - clearance / comfort)^2, ``comfort`` m beyond
    ``margin`` m.
    """
    clear = blocks(np.maximum, distance, factor).astype(np.float64) - margin
    short = np.maximum(0.0, 1.0 - clear / comfort)
    return np.where(clear < 0.0, np.inf, 1.0 + NEAR_COST * short * short)


@njit(cache=True)
def add_encounters(cost, moving, encounter):
    """Add what moving obstacles cost where the robot would meet them; ``cost`` is a Field.

    A cell costs ``ENCOUNTER_COST`` times the probability of a contact at the time when a robot that
    drives straight there arrives, discounted as risk is.
    """
    hypotheses, steps = moving.travel.shape
    rows, columns = cost.values.shape
    a = cost.resolution
    for m, obstacle in enumerate(moving.obstacles):
        near = encounter.radius + obstacle.radius
        reach = near + DEVIATIONS * moving.deviation[m, steps - 1]
        for h in range(hypotheses):
            last = moving.travel[h, steps - 1]
            first_y, last_y = obstacle.y, obstacle.y + last * obstacle.vy
            first_x, last_x = obstacle.x, obstacle.x + last * obstacle.vx
            low = max(0, int((min(first_x, last_x) - reach - cost.x0) / a))
            high = min(columns - 1, int((max(first_x, last_x) + reach - cost.x0) / a))
            bottom = max(0, int((min(first_y, last_y) - reach - cost.y0) / a))
            top = min(rows - 1, int((max(first_y, last_y) + reach - cost.y0) / a))
            for row in range(bottom, top + 1):
                y = cost.y0 + (row + 0.5) * a
                for column in range(low, high + 1):
                    x = cost.x0 + (column + 0.5) * a
                    away_x, away_y = x - encounter.x, y - encounter.y
                    arrives = math.sqrt(away_x * away_x + away_y * away_y) / encounter.speed
                    k = int(math.floor(arrives / encounter.step - 0.5))
                    if k < 0 or k >= steps:
                        continue
                    travel, deviation = moving.travel[h, k], moving.deviation[m, k]
                    dx = obstacle.x + travel * obstacle.vx - x
                    dy = obstacle.y + travel * obstacle.vy - y
                    square, within = dx * dx + dy * dy, near + DEVIATIONS * deviation
                    if square < within * within:
                        p = contact_probability(math.sqrt(square) - near, deviation)
                        p *= WEIGHTS[h] * moving.discount[k]
                        cost.values[row, column] += ENCOUNTER_COST * p
