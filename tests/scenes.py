"""Scenes for a dynamic window, made by hand."""

import math

import numpy as np

from dynastar.clearance import lower_bounds
from dynastar.dwa import DwaConfig, Scene
from dynastar.dwa.clearance import Closed
from dynastar.dwa.dwa import rules_of
from dynastar.dwa.rollout import Start
from dynastar.dwa.scene import AT_REST, Surroundings
from dynastar.dwa.terms import most_progress
from dynastar.field import Field
from dynastar.guidance.cost_to_go import End, with_descent
from dynastar.guidance.marching import Seed, extend, march, queue_for
from dynastar.perception import PredictionConfig
from dynastar.perception.hidden import Hidden
from dynastar.perception.local_map_kernels import BOX
from dynastar.perception.prediction import Times, predict

CELL, SIDE = 0.05, 160  # 8 x 8 m, from (0, 0)
PERIOD = 0.1  # s between commands
STEP, STEPS = 0.1, 80  # s, of the prediction


def empty():
    """Mask of closed cells: the outermost ones."""
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


def scattered(random, fraction=0.004):
    """``empty`` and a random fraction of the other cells."""
    return empty() | (random.random((SIDE, SIDE)) < fraction)


def field_of(closed):
    """The distance field of closed cells."""
    return Field(lower_bounds((~closed).astype(np.uint8), CELL), 0.0, 0.0, CELL)


def closed_space(closed):
    """Closed cells, in each of which a hit lies at the centre."""
    hits = np.zeros(closed.shape, BOX)
    return Closed(field_of(closed), closed, hits)


def boxes_of(closed):
    """What may stand in a ``Closed``: boxes (k, 4: low x, high x, low y, high y; m), and which are hits."""
    cells = np.argwhere(closed.distance.values == 0.0)
    half = CELL / math.sqrt(2.0)
    whole = np.array([-half, half, -half, half])
    hits = closed.hits[tuple(cells.T)]
    hits = np.column_stack([hits[name] for name in hits.dtype.names])
    hit = closed.occupied[tuple(cells.T)]
    boxes = np.where(hit[:, None], hits, whole)
    return boxes + ((cells[:, ::-1] + 0.5) * CELL).repeat(2, axis=1), hit


def centres_of(closed):
    """Centres (k, 2) of the closed cells, metres."""
    return (np.argwhere(closed)[:, ::-1] + 0.5) * CELL


FAR_AWAY = End(1e9, 1e9, 0.0, 1.0)


def cost_to_go_of(value, filled, resolution, end=FAR_AWAY):
    """A CostToGo from the values of a march, low corner at the origin."""
    return with_descent(Field(value, 0.0, 0.0, resolution), filled, end)


def cost_to_go_to(goal, closed, radius):
    """The cost-to-go to ``goal`` (m) of a disc, at 1 a metre."""
    n, a = SIDE // 2, 2 * CELL
    room = field_of(closed).values.reshape(n, 2, n, 2).max(axis=(1, 3)) >= radius
    row, column = int(goal[1] / a), int(goal[0] / a)
    right, up = goal[0] - (column + 0.5) * a, goal[1] - (row + 0.5) * a
    cost, seed = np.where(room, 1.0, np.inf), Seed(row, column, 0.0, right, up)
    value = march(cost, a, seed, (row, column), 99.0, queue_for(n * n))
    return cost_to_go_of(value, extend(value, a), a, End(*goal[:2], 0.0, 1.0))


def hidden_in(distance, speed):
    """Unseen space with ``distance`` (80, 80) to possible bodies."""
    return Hidden(Field(np.asarray(distance, np.float32), 0.0, 0.0, 2 * CELL), speed)


NOTHING_HIDDEN = hidden_in(np.full((SIDE // 2, SIDE // 2), 9.0), 0.0)


def scene_of(closed, goal=(7.0, 4.0), moving=(), radius=0.3, margin=0.05, latency=0.0, **others):
    """A scene in which all closed cells are occupied; ``others`` are more of its fields.

    ``moving`` are moving obstacles, ``radius`` (m) is that for which the cost-to-go is computed.
    """
    distance = field_of(closed)
    around = Surroundings(
        closed=closed_space(closed),
        moving=predict(moving, PredictionConfig(), Times(latency, STEP, STEPS)),
        hidden=others.pop("hidden", NOTHING_HIDDEN),
        margin_to_closed=margin,
        latency=latency,
    )
    scene = Scene(
        around=around,
        distance_to_obstacle=distance,
        distance_to_path=distance,
        cost_to_go=cost_to_go_to(goal, closed, radius + margin),
        margin=margin,
        last=AT_REST,
        v_cap=9.0,
        path_weight=0.0,
    )
    return scene._replace(**others)


def rules_for(robot, config=DwaConfig()):
    """The rules of a robot that is commanded every ``PERIOD``."""
    return rules_of(robot, config, PERIOD)


def start_of(rules, state, gap, cost_to_go):
    """Where roll-outs begin, with ``gap`` (m) of clearance and ``cost_to_go`` (m) left."""
    return Start(state, gap, cost_to_go, most_progress(rules, state.v, cost_to_go))
