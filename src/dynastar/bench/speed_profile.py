"""How fast a path can be driven: slow enough for its bends, its speed limits and its end."""

import math

import numpy as np
import numpy.typing as npt

from dynastar.path import Path
from dynastar.robot import Limits

SPACING = 0.1  # m between the points of the profile
BEND = 0.4  # m either side of a point over which the path's change of heading counts as one bend
SWING = 0.2  # m that the robot may swing wide of the path or cut it in a bend
GENTLE = 0.7  # share of the braking that slowing down for what is ahead may use
SLOWEST = 0.1  # m/s, so that nothing ahead but a lower limit stops the robot short of it

Floats = npt.NDArray[np.float64]


class SpeedProfile:
    """The largest speed at every point of a path that leaves time to slow down for what follows.

    ``speed_limit`` (n,) m/s is the map's at ``points(path)``.
    """

    def __init__(self, path: Path, limits: Limits, speed_limit: Floats) -> None:
        self._arc = np.linspace(0.0, path.length, len(speed_limit))
        self._v_max = limits.v_max
        twice_brake = 2.0 * GENTLE * limits.v_brake
        speed = np.minimum(
            np.minimum(limits.v_max, speed_limit), turning_speed(path, self._arc, limits)
        )
        speed[-1] = 0.0
        speed = np.minimum.reduce(
            [speed, np.append(speed[1:], 0.0), np.append(speed[:1], speed[:-1])]
        )
        # v^2 + 2 b s may not exceed that of any later point.
        energy = speed**2 + twice_brake * self._arc
        ahead = np.minimum.accumulate(energy[::-1])[::-1] - twice_brake * self._arc
        slowest = np.minimum(speed_limit, min(SLOWEST, limits.v_max))
        self._speed = np.maximum(np.sqrt(np.maximum(ahead, 0.0)), slowest)

    def at(self, s: float) -> float:
        """The speed (m/s) at ``s`` metres along the path."""
        return float(self.along(np.array(s)))

    def along(self, s: Floats) -> Floats:
        """The speeds (n,) m/s at ``s`` (n,) metres along the path."""
        return np.minimum(np.interp(s, self._arc, self._speed), self._v_max)


def points(path: Path) -> Floats:
    """The points (n, 2) of a path that a profile is made at."""
    return path.resampled(0.0, path.length, SPACING)


def turning_speed(path: Path, arc: Floats, limits: Limits) -> Floats:
    """The speed (m/s) at which the path's bend at each arc length can be driven."""

    def heading(s: Floats) -> Floats:
        before = np.clip(s - 1e-3, 0.0, path.length - 2e-3)
        after = before + 2e-3
        dx, dy = (
            np.interp(after, path.arc, column) - np.interp(before, path.arc, column)
            for column in path.points.T
        )
        return np.arctan2(dy, dx)

    turn = heading(arc + BEND) - heading(arc - BEND)
    return bend_speed(np.abs(np.remainder(turn + math.pi, 2.0 * math.pi) - math.pi), limits)


def bend_speed(angle: Floats | float, limits: Limits) -> Floats:
    """The speed (m/s) at which a bend by ``angle`` (rad) can be driven.

    A turn by phi takes T = 2 sqrt(phi / a), or phi / omega + omega / a once omega_max is reached;
    swinging no further than d off the corner leaves a length of 4 d / tan(phi / 2) for it.
    """
    phi = np.clip(angle, 1e-3, 3.0)
    omega, accel = limits.omega_max, min(limits.omega_accel, limits.omega_brake)
    time = np.where(
        phi < omega * omega / accel, 2.0 * np.sqrt(phi / accel), phi / omega + omega / accel
    )
    return np.asarray(4.0 * SWING / (np.tan(0.5 * phi) * time))
