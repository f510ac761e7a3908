"""Frames from tf: the newest transform of each, and chains of them (REP 105)."""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.errors import InputError
from dynastar.geometry import Pose2D

NEAR = 0.02  # m and rad
MOST_TILT = 5.0  # degrees between two planes, or of a pose, that count as level
LONGEST = 50  # frames in a chain
SET_BACK = (
    0.5  # s by which a stamp has to be older than the one before for a clock that was set back
)

Matrix = npt.NDArray[np.float64]


class Mount(NamedTuple):
    """A planar sensor on the robot: its pose, and whether its z axis points down."""

    pose: Pose2D
    upside_down: bool = False

    def is_near(self, other: "Mount") -> bool:
        """Whether scans from both show about the same."""
        turn = abs(math.remainder(self.pose.theta - other.pose.theta, math.tau))
        apart = math.dist(self.pose[:2], other.pose[:2])
        return self.upside_down == other.upside_down and max(apart, turn) < NEAR


class Transforms:
    """What /tf and /tf_static have said: for each frame its parent, the transform and its stamp."""

    def __init__(self) -> None:
        self._parents: dict[str, tuple[str, Matrix, float]] = {}

    def clear(self) -> None:
        """Drops what was said on /tf; what is static stays."""
        self._parents = {
            child: found for child, found in self._parents.items() if found[2] == math.inf
        }

    def add(self, message: Any, static: bool) -> None:
        """Takes in a tf2_msgs/TFMessage; InputError where a transform is not finite, after all others.

        One that is a little older than the one that is known is left out; by more, the clock was set back.
        """
        wrong = None
        for one in message.transforms:
            parent, child = (name.lstrip("/") for name in (one.header.frame_id, one.child_frame_id))
            stamp = float(one.header.stamp.sec) + 1e-9 * float(one.header.stamp.nanosec)
            known = self._parents.get(child)
            late = known is not None and known[0] == parent
            if late and known is not None:
                late = known[2] == math.inf or -SET_BACK < stamp - known[2] < 0.0
            try:
                matrix = _matrix(one.transform, child)
            except InputError as error:
                wrong = error
                continue
            if static or not late:
                self._parents[child] = (parent, matrix, math.inf if static else stamp)
        if wrong is not None:
            raise wrong

    def ages(self, parent: str, child: str, now: float) -> list[float]:
        """Seconds since the stamps of the transforms from a frame to one above it, but for static ones."""
        frame = child
        found: list[float] = []
        while frame != parent and frame in self._parents and len(found) < LONGEST:
            frame, _, stamp = self._parents[frame]
            found.append(now - stamp)
        return [age for age in found if math.isfinite(age)]

    def planar(self, parent: str, child: str) -> Mount | None:
        """Pose of a frame in another above it, None if they are not connected.

        InputError where the planes of the two are tilted against each other.
        """
        found, frame = np.eye(4), child
        for _ in range(LONGEST):
            if frame == parent:
                break
            if frame not in self._parents:
                return None
            frame, matrix, _ = self._parents[frame]
            found = matrix @ found
        else:
            raise InputError(f"the transforms above the frame '{child:.80}' form a loop")
        up = found[2, 2]
        check_level(f"the frame '{child:.80}', seen from '{parent:.80}',", abs(float(up)))
        pose = Pose2D(float(found[0, 3]), float(found[1, 3]), math.atan2(found[1, 0], found[0, 0]))
        return Mount(pose, bool(up < 0.0))


def check_level(what: str, up: float) -> None:
    """Raises InputError for a tilt of more than MOST_TILT; ``up`` is the cosine of the tilt."""
    tilt = math.degrees(math.acos(min(max(up, -1.0), 1.0)))
    if tilt > MOST_TILT + 1e-6:  # the rounding of messages
        raise InputError(f"{what} is tilted by {tilt:.1f} degrees: expected at most {MOST_TILT:g}")


def _matrix(transform: Any, child: str) -> Matrix:
    """A geometry_msgs/Transform as a homogeneous matrix (4, 4)."""
    moved, turn = transform.translation, transform.rotation
    q = np.array([turn.w, turn.x, turn.y, turn.z], dtype=np.float64)
    p = np.array([moved.x, moved.y, moved.z], dtype=np.float64)
    norm = math.sqrt(float(q @ q))
    if not (np.isfinite(p).all() and 0.9 < norm < 1.1):
        raise InputError(f"the transform of the frame '{child:.80}' is not finite, or no rotation")
    w, x, y, z = q / norm
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = p
    return matrix
