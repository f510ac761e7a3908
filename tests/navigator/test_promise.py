"""The promise: within the declared bounds a static world is never touched by a moving robot.

Every world is drawn from its own number, so a failure is run again with ``drive(number)``.
``DYNASTAR_WORLDS`` is how many to drive.
"""

import math
import os
from dataclasses import replace

import numpy as np
import pytest

from dynastar.errors import PlanningError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Navigator
from dynastar.robot import ROBOTS, Lidar, Limits, Robot, slew
from dynastar.simulation import Noise, Scenario, run
from dynastar.simulation.contact import Solids

WORLDS = int(os.environ.get("DYNASTAR_WORLDS", 30))
EMPTY = OccupancyGrid(np.zeros((1, 1), np.int8), GridFrame(40.0, -20.0, -20.0))
OUTCOMES = {"arrived", "blocked", "timeout", "sensor_lost", "contact"}


class Watched:
    """A Navigator whose every command is held against what the drive can do."""

    def __init__(self, grid, robot, config):
        self.inner, self.limits, self.config = Navigator(grid, robot, config), robot.limits, config
        self._sent = []

    @property
    def status(self):
        return self.inner.status

    def set_goal(self, goal):
        self.inner.set_goal(goal)

    def command(self, state, scan):
        command = self.inner.command(state, scan)
        limits, period = self.limits, self.config.period
        assert limits.v_min - 1e-6 <= command.v <= limits.v_max + 1e-6, command
        assert abs(command.omega) <= limits.omega_max + 1e-6, command
        now = self._as_it_acts(state)
        v = slew(now.v, command.v, limits.v_accel, limits.v_brake, period)
        omega = slew(now.omega, command.omega, limits.omega_accel, limits.omega_brake, period)
        assert abs(v - command.v) < 1e-6, (state.stamp, now, command)
        assert abs(omega - command.omega) < 1e-6, (state.stamp, now, command)
        self._sent.append((state.stamp, command))
        return command

    def _as_it_acts(self, state):
        """The speeds when a command given now acts: those on their way are carried out first."""
        limits, latency = self.limits, self.config.latency
        v, omega = state.twist
        ends = [stamp + latency for stamp, _ in self._sent[1:]] + [state.stamp + latency]
        for (stamp, wanted), end in zip(self._sent, ends, strict=bool(self._sent)):
            span = end - max(stamp + latency, state.stamp)
            if span > 1e-9:
                v = slew(v, wanted.v, limits.v_accel, limits.v_brake, span)
                omega = slew(omega, wanted.omega, limits.omega_accel, limits.omega_brake, span)
        return Twist(v, omega)


def random_world(number):
    """A mission in a small static world that keeps within what the promise is made for."""
    random = np.random.default_rng(number)
    robot = random_robot(random)
    noise = Noise(
        *(float(random.choice([0.0, random.uniform(0.0, b)])) for b in (0.05, 0.04, 0.04))
    )
    narrowest = float(random.uniform(0.08, 0.25))
    settings = random_settings(random, robot, narrowest)
    cell = float(random.choice([0.05, 0.1, 0.25, 0.5, 1.0]))
    rows, columns = (round(side / cell) for side in random.uniform(6.0, 12.0, 2))
    grid = random_grid(random, rows, columns, cell, narrowest)
    start, goal, obstacles = random_mission(random, grid, robot, noise, settings)
    return Scenario(
        f"world {number}",
        grid,
        robot,
        start,
        (Goal(*goal, float(random.uniform(-3.0, 3.0)) if random.random() < 0.2 else None),),
        obstacles=obstacles,
        noise=noise,
        latency=float(random.choice([0.0, random.uniform(0.0, 0.3)])),
        time_limit=float(random.uniform(10.0, 20.0)),
        unknown=str(random.choice(["blocked", "free"])),
        seed=number,
        preset=str(random.choice(["default", "paper"])),
        navigator=settings,
    )


def random_robot(random):
    if random.random() < 0.4:
        return ROBOTS[str(random.choice(list(ROBOTS)))]
    limits = Limits(
        v_max=float(random.uniform(0.2, 2.0)),
        omega_max=float(random.uniform(0.3, 3.0)),
        v_accel=float(random.uniform(0.2, 3.0)),
        omega_accel=float(random.uniform(0.3, 5.0)),
        v_brake=float(random.uniform(0.2, 3.0)),
        omega_brake=float(random.uniform(0.3, 5.0)),
        v_min=float(random.choice([0.0, -0.2])),
    )
    if random.random() < 0.5:
        footprint = Footprint.disc(float(random.uniform(0.08, 0.4)))
    else:
        corners = int(random.integers(3, 8))
        angles = (np.arange(corners) + random.uniform(-0.2, 0.2, corners)) * math.tau / corners
        ring = np.column_stack([np.cos(angles), np.sin(angles)]) * random.uniform(0.15, 0.4, 2)
        footprint = Footprint.polygon((ring + random.uniform(-0.02, 0.02, 2)).tolist())
    fov = float(random.choice([math.tau, random.uniform(math.pi / 2, math.tau)]))
    lidar = Lidar(
        beams=int(random.integers(90, 721)),
        fov=fov,
        range_min=float(random.choice([0.0, random.uniform(0.0, 0.4)])),
        range_max=float(random.uniform(3.0, 6.0)),
        x=float(random.uniform(-0.8, 0.8) * footprint.inscribed),
        y=float(random.uniform(-0.5, 0.5) * footprint.inscribed),
        theta=float(random.choice([0.0, random.uniform(-0.5, 0.5)])),
    )
    return Robot("random", limits, footprint, lidar)


def random_settings(random, robot, narrowest):
    dwa = {
        "arc_time": random.uniform(0.2, 1.5),
        "horizon": random.uniform(1.0, 5.0),
        "reach": random.choice([0.0, random.uniform(0.0, 2.0)]),
        "v_samples": int(random.integers(2, 9)),
        "omega_samples": int(random.integers(2, 15)),
        "comfort": random.uniform(0.05, 0.6),
        "hysteresis": random.uniform(0.0, 0.2),
    }
    if random.random() < 0.5:
        names = ("heading", "dist", "vel", "risk")
        weights = random.uniform((0.3, 0.0, 0.0, 0.0), (1.0, 0.5, 0.6, 10.0)).tolist()
        dwa["weights"] = dict(zip(names, weights, strict=True))
    return {
        "period": random.uniform(0.05, 0.2),
        "hidden_speed": float(random.choice([0.0, random.uniform(0.0, 1.0)])),
        "resolution": random.uniform(0.04, 0.12),
        "comfort": random.uniform(0.0, 0.3),
        "stuck_time": random.uniform(0.5, 4.0),
        "local_map": {
            "size": random.uniform(6.0, 9.0),
            "memory": random.uniform(1.0, 30.0),
            "narrowest": narrowest,
        },
        "dwa": {key: value for key, value in dwa.items() if random.random() < 0.5},
    }


def random_grid(random, rows, columns, cell, narrowest):
    """Walls no thinner than ``narrowest``, and here and there an unknown patch."""
    values = np.zeros((rows, columns), np.int8)
    thinnest = math.ceil(narrowest / cell)
    for state, count in ((100, random.integers(0, 7)), (-1, random.integers(0, 3))):
        for _ in range(count):
            height, width = random.integers(thinnest, thinnest + max(2, int(1.5 / cell)), 2)
            row, column = random.integers(0, rows), random.integers(0, columns)
            values[row : row + height, column : column + width] = state
    edge = values == 100
    for rim in (edge[:thinnest], edge[-thinnest:], edge[:, :thinnest].T, edge[:, -thinnest:].T):
        rim[:, rim.any(axis=0)] = True  # what the border cuts thin is not thin: the border is solid
    values[edge] = 100
    corner = random.uniform(-5.0, 5.0, 2)
    yaw = random.choice([0.0, random.uniform(-3.0, 3.0)])
    return OccupancyGrid(values, GridFrame(cell, *map(float, corner), float(yaw)))


def random_mission(random, grid, robot, noise, settings):
    """A start and a goal with room on the map, and obstacles beyond what a start takes as free."""
    radius, local_map = robot.footprint.circumscribed, settings["local_map"]
    known = Solids(grid)

    def somewhere(room):
        for _ in range(200):
            cell = random.uniform(0.0, 1.0, 2) * grid.values.shape
            x, y = grid.frame.to_world(*cell)
            at = Pose2D(float(x), float(y), float(random.uniform(-math.pi, math.pi)))
            if known.gap(at, Footprint.disc(room)) > 0.0:
                return at
        return None

    start = somewhere(radius + random.uniform(0.03, 0.2))
    goal = max((somewhere(radius + 0.15) for _ in range(2)), key=lambda at: _gap(start, at))
    bare = radius + robot.lidar.range_min + 2.0 * settings["resolution"] + 2.0 * noise.pose_bound
    obstacles = []
    for _ in range(random.integers(0, 9)):
        at = np.array(somewhere(0.0)[:2])
        if random.random() < 0.5:  # near the way
            at = np.array(start[:2]) + random.uniform(0.1, 1.0) * np.subtract(goal[:2], start[:2])
            at += random.normal(0.0, 0.5, 2)
        ring = random_ring(random, local_map["narrowest"]) + at
        nearest = Solids(EMPTY, [ring - start[:2]]).gap(Pose2D(0.0, 0.0), Footprint.disc(bare))
        if nearest > 0.0:
            obstacles.append(ring)
    heading = start.theta if random.random() < 0.5 else None
    return (start.x, start.y, heading), (goal.x, goal.y), tuple(obstacles)


def _gap(a, b):
    return -1.0 if a is None or b is None else math.dist(a[:2], b[:2])


def random_ring(random, narrowest):
    """A disc or a box round the origin, nowhere narrower than ``narrowest``."""
    if random.random() < 0.5:
        radius = random.uniform(0.5 * narrowest, 0.5) / math.cos(math.pi / 24)
        angles = np.arange(24) * math.tau / 24
        return radius * np.column_stack([np.cos(angles), np.sin(angles)])
    x, y = 0.5 * random.uniform(narrowest, 1.0, 2)
    turn = random.uniform(0.0, math.pi)
    cos, sin = math.cos(turn), math.sin(turn)
    return np.array([(x, y), (-x, y), (-x, -y), (x, -y)]) @ np.array([[cos, sin], [-sin, cos]])


def drive(number, perfect=False):
    world = random_world(number)
    if perfect:  # nothing is declared, and nothing is wrong
        settings = {**world.navigator, "drive_error": 0.0}
        world = replace(world, noise=Noise(0.0, 0.0, 0.0), latency=0.0, navigator=settings)
    return run(world, navigator=Watched)


@pytest.mark.slow
@pytest.mark.parametrize("errors", ["none", "random", "at the bound"])
def test_a_static_world_is_never_touched(errors, monkeypatch):
    if errors == "at the bound":  # every range too long, every position off to the corner
        for where in ("lidar", "world"):
            monkeypatch.setattr(
                f"dynastar.simulation.{where}.cut_gaussian",
                lambda _, bound, count: np.full(count, bound),
            )
    broken, driven, moved = {}, 0, 0.0
    for number in range(WORLDS):
        try:
            episode = drive(number, errors == "none")
        except AssertionError as wrong:  # a command outside the limits
            broken[number] = str(wrong)
            continue
        except PlanningError:
            continue  # a start or goal that the map does not allow is said before anything moves
        driven += 1
        moved += episode.trajectory.path.length
        assert episode.outcome in OUTCOMES
        if episode.contact == "moving":
            broken[number] = episode.reason
    assert not broken
    assert driven > 0.6 * WORLDS
    assert moved > 1.0 * driven  # metres: who stands touches nothing
