"""What a dynamic window is judged against, made by hand."""

import math

import numpy as np

from dynastar.clearance import DistanceField, lower_bounds
from dynastar.dwa import CostToGo, Scene
from dynastar.dwa.cost_to_go import descend
from dynastar.dwa.marching import extend, march, queue_for
from dynastar.dwa.scene import AT_REST
from dynastar.perception import PredictionConfig
from dynastar.perception.hidden import Hidden
from dynastar.perception.prediction import predict

CELL, SIDE = 0.05, 160  # 8 x 8 m, from (0, 0)
NOBODY_HIDDEN = Hidden(
    np.full((SIDE // 2, SIDE // 2), 9.0, np.float32), 0.0, 0.0, 0.1, 0.25, 0.0, 0.1
)
STEP, HORIZON = 0.1, 80


def empty():
    """Which cells are closed where nothing is but the rim."""
    closed = np.zeros((SIDE, SIDE), bool)
    closed[[0, -1]] = closed[:, [0, -1]] = True
    return closed


def boxed(*boxes):
    """``empty`` and boxes (x0, y0, x1, y1) in metres."""
    closed = empty()
    for box in boxes:
        x0, y0, x1, y1 = (round(metres / CELL) for metres in box)
        closed[y0:y1, x0:x1] = True
    return closed


def field_of(closed):
    """The distance field of closed cells."""
    return DistanceField(lower_bounds((~closed).astype(np.uint8), CELL), 0.0, 0.0, CELL)


def centres_of(closed):
    """Centres (k, 2) of the closed cells, metres."""
    return (np.argwhere(closed)[:, ::-1] + 0.5) * CELL


def cost_to_go(closed, goal, radius):
    """The cost-to-go to ``goal`` of a disc, without any soft cost."""
    n = SIDE // 2
    room = field_of(closed).distance.reshape(n, 2, n, 2).max(axis=(1, 3)) >= radius
    value, filled, slope = np.empty((n, n)), np.empty((n, n)), np.empty((n, n, 2))
    row, column = (int(metres / (2 * CELL)) for metres in goal[::-1])
    cost = np.where(room, 1.0, np.inf)
    march(cost, 2 * CELL, (row, column, 0.0), (row, column), 99.0, value, queue_for(n * n))
    extend(value, 2 * CELL, filled)
    descend(value, filled, slope)
    return CostToGo(value, filled, slope, 0.0, 0.0, 2 * CELL)


def scene_of(closed, goal=(7.0, 4.0), movers=(), radius=0.3, margin=0.05, hidden=NOBODY_HIDDEN,
             ahead=0.0, last=AT_REST, v_cap=9.0, path=None, sigma=0.0):  # fmt: skip
    """A scene in which all that is closed is occupied, too."""
    field = field_of(closed)
    people = predict(movers, PredictionConfig(), (ahead, STEP, HORIZON))
    to_go = cost_to_go(closed, goal, radius + margin)
    return Scene(
        field, field, to_go, people, hidden, margin, margin, ahead, last, v_cap,
        field if path is None else path, sigma,
    )  # fmt: skip


def state_of(x, y, theta, v=0.0, omega=0.0):
    """A state as the kernels take it."""
    return (x, y, math.cos(theta), math.sin(theta)), v, omega
