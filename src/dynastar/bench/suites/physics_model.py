"""A robot on two driven wheels and castors among boxes, as a model of MuJoCo.

The hull collides with obstacles only, wheels and castors with the floor only.
"""

import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Robot
from dynastar.simulation import Scenario

Floats = npt.NDArray[np.float64]

STEP = 0.002  # s, at most
SETTLING = 0.5  # s, until the robot stands on its wheels
RESPONSE = 0.05  # s, time constant of the wheels' speed without a payload
STRENGTH = 3.0  # times the torque that braking at the limit takes with the payload
WALL, LOW, HIGH = 0.5, 0.03, 0.25  # m, heights of walls, and of the hull's bottom and top
CASTOR, LIFTED = 0.02, 0.0005  # m, radius of castors, and how far they begin above the floor


@dataclass(frozen=True)
class Body:
    """What a robot is made of: ``mass`` and ``payload`` (kg), ``castors`` (x, y) m from the axle."""

    mass: float
    payload: float
    track: float
    wheel: float
    castors: tuple[tuple[float, float], ...]

    def response(self, loaded: bool) -> float:
        """Time constant (s) with which the wheels follow a commanded speed."""
        return RESPONSE * (1.0 + loaded * self.payload / self.mass)


class Engine:
    """The physics of a robot: ``pose``, ``twist`` and ``wheels`` are read from the engine.

    ``floor`` is the friction of wheels on it.
    """

    def __init__(
        self, scenario: Scenario, start: Pose2D, body: Body, floor: float, loaded: bool
    ) -> None:
        text = model_text(scenario, start, body, floor, loaded)
        self._model = mujoco.MjModel.from_xml_string(text)
        self._data = mujoco.MjData(self._model)
        self._hull, self._body = self._model.geom("hull").id, body
        self.drive(Twist(0.0, 0.0), SETTLING)

    @property
    def pose(self) -> Pose2D:
        """Pose of the middle of the axle."""
        x, y, _, w, i, j, k = self._data.qpos[:7]
        return Pose2D(float(x), float(y), math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k)))

    @property
    def twist(self) -> Twist:
        """Speeds over ground."""
        vx, vy, _, _, _, omega = self._data.qvel[:6]
        theta = self.pose.theta
        return Twist(float(vx * math.cos(theta) + vy * math.sin(theta)), float(omega))

    @property
    def wheels(self) -> Twist:
        """The speeds that the wheels turn with."""
        left, right = self._body.wheel * self._data.qvel[6:8]
        return Twist(float(0.5 * (left + right)), float((right - left) / self._body.track))

    def drive(self, wanted: Twist, duration: float) -> bool:
        """Lets ``duration`` (s) pass, or less where the hull touches something. Returns True if it does."""
        steps = max(1, math.ceil(duration / STEP - 1e-6))
        self._model.opt.timestep = duration / steps
        half = 0.5 * self._body.track * wanted.omega
        self._data.ctrl[:] = np.array([wanted.v - half, wanted.v + half]) / self._body.wheel
        for _ in range(steps):
            mujoco.mj_step(self._model, self._data)
            if (self._data.contact.geom == self._hull).any():
                return True
        return False


def model_text(scenario: Scenario, start: Pose2D, body: Body, floor: float, loaded: bool) -> str:
    """The model in MuJoCo's format."""
    wheel, load = body.wheel, body.mass + body.payload
    gain = 0.5 * body.mass * wheel**2 / RESPONSE
    torque = 0.5 * STRENGTH * load * scenario.robot.limits.v_brake * wheel
    ground = f'contype="0" conaffinity="1" friction="{floor} .005 .0001"'
    slides = 'contype="0" conaffinity="1" friction=".01 .001 .0001" priority="1"'
    wheels = "".join(
        f'<body pos="0 {side} 0"><joint name="{name}" axis="0 1 0" damping="0.001"/>'
        f'<geom type="ellipsoid" size="{wheel} .01 {wheel}" mass="{0.02 * body.mass}" '
        f"{ground}/></body>"
        for name, side in (("left", 0.5 * body.track), ("right", -0.5 * body.track))
    )
    castors = "".join(
        f'<geom type="sphere" size="{CASTOR}" pos="{x} {y} {CASTOR - wheel + LIFTED}" '
        f'mass="{0.01 * body.mass}" {slides}/>'
        for x, y in body.castors
    )
    motors = "".join(
        f'<velocity joint="{name}" kv="{gain}" forcerange="{-torque} {torque}"/>'
        for name in ("left", "right")
    )
    return f"""<mujoco><option integrator="implicitfast" cone="elliptic" impratio="10"/><worldbody>
<geom type="plane" size="100 100 .1" contype="1" conaffinity="0" friction="{floor} .005 .0001"/>
{"".join(map(_wall, solids(scenario)))}
<body pos="{start.x} {start.y} {wheel}" euler="0 0 {math.degrees(start.theta)}"><freejoint/>
{_hull(scenario.robot, wheel, load if loaded else body.mass)}{wheels}{castors}</body></worldbody>
<actuator>{motors}</actuator></mujoco>"""


def solids(scenario: Scenario) -> list[tuple[float, float, float, float, float]]:
    """Boxes of map and obstacles: x and y of the middle, half length, half width (m), yaw (rad)."""
    grid = scenario.grid if scenario.world is None else scenario.world
    side = grid.resolution
    boxes = [
        (
            0.5 * side * (a + b),
            0.5 * side * (c + d),
            0.5 * side * (b - a),
            0.5 * side * (d - c),
            0.0,
        )
        for c, d, a, b in rectangles(grid.occupied)
    ]
    for ring in scenario.obstacles:  # rectangles
        along, across = ring[1] - ring[0], ring[3] - ring[0]
        x, y = ring.mean(axis=0)
        yaw = math.atan2(along[1], along[0])
        boxes.append((x, y, 0.5 * math.hypot(*along), 0.5 * math.hypot(*across), yaw))
    return boxes


def rectangles(occupied: npt.NDArray[np.bool_]) -> list[tuple[int, int, int, int]]:
    """Rectangles that cover the occupied cells: first and past-the-last row, then column."""
    open_runs: dict[tuple[int, int], int] = {}
    found = []
    for row in range(len(occupied) + 1):
        runs = set()
        if row < len(occupied):
            edges = np.flatnonzero(np.diff(np.pad(occupied[row].astype(np.int8), 1)))
            runs = set(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
        for run in [run for run in open_runs if run not in runs]:
            found.append((open_runs.pop(run), row, *run))
        for run in runs:
            open_runs.setdefault(run, row)
    return found


def _wall(box: tuple[float, float, float, float, float]) -> str:
    x, y, length, width, yaw = box
    return (
        f'<geom type="box" pos="{x} {y} {0.5 * WALL}" size="{length} {width} {0.5 * WALL}" '
        f'euler="0 0 {math.degrees(yaw)}" contype="2" conaffinity="0"/>'
    )


def _hull(robot: Robot, wheel: float, mass: float) -> str:
    height, middle = 0.5 * (HIGH - LOW), 0.5 * (HIGH + LOW) - wheel
    footprint = robot.footprint
    shape = f'type="cylinder" size="{footprint.circumscribed} {height}" pos="0 0 {middle}"'
    if not footprint.is_disc:  # a rectangle along x
        low, high = footprint.vertices.min(axis=0), footprint.vertices.max(axis=0)
        (x, y), (length, width) = 0.5 * (low + high), 0.5 * (high - low)
        shape = f'type="box" size="{length} {width} {height}" pos="{x} {y} {middle}"'
    return f'<geom name="hull" {shape} mass="{mass}" contype="0" conaffinity="2"/>'
