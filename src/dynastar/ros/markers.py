"""Markers for RViz and Foxglove: the robot, the candidates of the window, the tracks."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import RobotState, Status
from dynastar.robot import arc
from dynastar.ros.outgoing import Colour, Messages

AHEAD = 1.0  # s for which a candidate's arc is drawn
POINTS = 6  # of a drawn arc
WORST, BEST = np.array((0.84, 0.37, 0.0)), np.array((0.0, 0.45, 0.70))  # of the scores
REFUSED: Colour = (0.6, 0.6, 0.6, 0.5)
TRACK = (0.0, 0.62, 0.45)
ROBOT: Colour = (0.29, 0.08, 0.38, 0.8)
HELD_BACK: Colour = (0.9, 0.6, 0.0, 0.9)
SIDES = 24  # of the polygon that is drawn for a disc
CYLINDER, LINE_STRIP, LINE_LIST = 3, 4, 5  # types of a Marker
DELETE_ALL = 3  # an action of a Marker
LINE = 0.01  # m, width of the arcs
NAMESPACES = "robot", "candidates", "tracks"


class Markers:
    """Makes the markers of a tick, in one frame."""

    def __init__(self, messages: Messages, frame: str) -> None:
        self._messages, self._frame = messages, frame

    def array(self, footprint: Footprint, status: Status, state: RobotState, now: float) -> Any:
        """All markers of a tick; those of the tick before are deleted."""
        markers = [
            self._marker("", 0, 0.0, now, action=DELETE_ALL),
            self._robot(footprint, state, now),
            self._candidates(status, state, now),
            *self._tracks(status, now),
        ]
        return self._messages.make("visualization_msgs/msg/MarkerArray", markers=markers)

    def stop(
        self, footprint: Footprint, poses: npt.NDArray[np.float64], held_back: bool, now: float
    ) -> Any:
        """The outline of the footprint at each pose (n, 3) of a stop, orange if that was held back."""
        out, outline, points = self._messages, outline_of(footprint), []
        for *place, theta in poses:
            cos, sin = math.cos(theta), math.sin(theta)
            placed = outline @ np.array([[cos, sin], [-sin, cos]]) + place
            for side in pairwise([*placed, placed[0]]):
                points += [out.point(x, y, 0.05) for x, y in side]
        colour = out.colour(HELD_BACK if held_back else (*TRACK, 0.9))
        marker = self._marker("stop", LINE_LIST, LINE, now, color=colour, points=points)
        return out.make("visualization_msgs/msg/MarkerArray", markers=[marker])

    def _robot(self, footprint: Footprint, state: RobotState, now: float) -> Any:
        """The footprint: a disc, or the outline of its polygon."""
        out = self._messages
        pose, colour = out.pose(state.pose), out.colour(ROBOT)
        if footprint.is_disc:
            size = 2.0 * footprint.circumscribed
            return self._marker("robot", CYLINDER, size, now, pose=pose, color=colour)
        ring = [*footprint.vertices, footprint.vertices[0]]
        points = [out.point(x, y) for x, y in ring]
        return self._marker("robot", LINE_STRIP, 0.03, now, pose=pose, color=colour, points=points)

    def _candidates(self, status: Status, state: RobotState, now: float) -> Any:
        """Arcs of the candidates: from orange for the worst score to blue, grey if refused."""
        out = self._messages
        points, colours = [], []
        for line, colour in _arcs(status, state):
            for a, b in pairwise(line):
                points += [out.point(a.x, a.y, 0.05), out.point(b.x, b.y, 0.05)]
                colours += 2 * [out.colour(colour)]
        return self._marker("candidates", LINE_LIST, LINE, now, points=points, colors=colours)

    def _tracks(self, status: Status, now: float) -> list[Any]:
        """Tracks where they are, and where they are predicted 1 s and 2 s ahead."""
        out = self._messages
        markers: list[Any] = []
        for track in status.tracks:
            for k, alpha in ((0, 0.9), (1, 0.4), (2, 0.2)):
                x, y = float(track.x + k * track.vx), float(track.y + k * track.vy)
                disc = {
                    "id": len(markers),
                    "pose": out.pose(Pose2D(x, y, 0.0)),
                    "color": out.colour((*TRACK, alpha)),
                }
                size = 2.0 * float(track.radius)
                markers.append(self._marker("tracks", CYLINDER, size, now, **disc))
        return markers

    def _marker(self, group: str, kind: int, size: float, now: float, **fields: Any) -> Any:
        out = self._messages
        header = out.header(self._frame, now)
        pose = fields.pop("pose", None) or out.pose(Pose2D(0.0, 0.0, 0.0))
        scale = out.make("geometry_msgs/msg/Vector3", x=size, y=size, z=0.1)
        shape = {"ns": group, "type": kind, "header": header, "pose": pose, "scale": scale}
        return out.make("visualization_msgs/msg/Marker", **shape, **fields)


def outline_of(footprint: Footprint) -> npt.NDArray[np.float64]:
    """The corners (n, 2) of a footprint, metres; a disc has many."""
    if not footprint.is_disc:
        return footprint.vertices
    angles = np.arange(SIDES) * math.tau / SIDES
    return footprint.circumscribed * np.column_stack([np.cos(angles), np.sin(angles)])


def _arcs(status: Status, state: RobotState) -> list[tuple[list[Pose2D], Colour]]:
    """The arc of each candidate with its colour, by its score between the worst and the best."""
    choice = status.choice
    if choice is None:
        return []
    score = choice.score
    good = (choice.refused == 0) & np.isfinite(score)
    low, high = (score[good].min(), score[good].max()) if good.any() else (0.0, 1.0)
    found = []
    for index, (v, omega) in enumerate(choice.samples):
        part = float((score[index] - low) / max(high - low, 1e-9)) if good[index] else math.nan
        red, green, blue = (WORST + part * (BEST - WORST)).tolist()
        colour = (red, green, blue, 0.9) if good[index] else REFUSED
        line = [arc(state.pose, Twist(v, omega), AHEAD * k / POINTS) for k in range(POINTS + 1)]
        found.append((line, colour))
    return found
