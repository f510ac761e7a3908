"""What a page may ask for: one table of fields for each kind of message, checked before it is used."""

import json
from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

from dynastar.config import Field, checked, choose, shown
from dynastar.errors import InputError
from dynastar.navigator import Preset

MOST_BYTES = 16384  # of a message
MOST_GOALS = 20
MOST_POINTS = 200  # of a stroke

Metres = Annotated[float, Field("a coordinate", "m", -1e6, 1e6)]
Speed = Annotated[float, Field("a speed", "m/s", -3.0, 3.0)]
Heading = Annotated[float | None, Field("any heading if null", "rad", -7.0, 7.0)]
Number = Annotated[int, Field("a moving obstacle, from 0", "", 0, 10**6)]


class Goals(NamedTuple):
    """Drive there, in order; after the goals that there are if ``more``; no goal: stop."""

    goals: tuple[tuple[Metres, Metres, Heading], ...]
    more: bool = False


class Stroke(NamedTuple):
    """Paint or erase along a line."""

    points: tuple[tuple[Metres, Metres], ...]
    radius: Annotated[float, Field("of the brush", "m", 0.05, 2.0)] = 0.15
    erase: bool = False


class Walker(NamedTuple):
    """Add a walker with this velocity."""

    x: Metres
    y: Metres
    vx: Speed
    vy: Speed


class Push(NamedTuple):
    """Send a mover another way."""

    mover: Number
    vx: Speed
    vy: Speed


class Setting(NamedTuple):
    """Change one of the settings that the scene lists."""

    name: str
    value: Annotated[float, Field("", "", -1e9, 1e9)]


class Choose(NamedTuple):
    """Drive by a preset."""

    preset: Preset


class Pause(NamedTuple):
    """Let time pass, or not."""

    paused: bool


class Step(NamedTuple):
    """While it is paused, let one period pass."""


class Reset(NamedTuple):
    """Begin the scene again, as it was made; what is set stays."""


class Load(NamedTuple):
    """Another of the scenes that come with dynastar."""

    scene: str


Message = Goals | Stroke | Walker | Push | Setting | Choose | Pause | Step | Reset | Load
KINDS: dict[str, type[Any]] = {
    "goals": Goals,
    "stroke": Stroke,
    "walker": Walker,
    "push": Push,
    "set": Setting,
    "preset": Choose,
    "pause": Pause,
    "step": Step,
    "reset": Reset,
    "scene": Load,
}


def read_message(text: str | bytes) -> Message:
    """The message in a JSON object, whose ``type`` names its kind. Raises InputError."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"a message is not JSON: {error!s:.80}") from None
    if not isinstance(found, Mapping) or not isinstance(found.get("type"), str):
        raise InputError(f"a message is {shown(found)}: expected an object with a type")
    fields = {key: value for key, value in found.items() if key != "type"}
    message: Message = checked(choose(found["type"], KINDS, "message"), fields, found["type"])
    if isinstance(message, Goals) and len(message.goals) > MOST_GOALS:
        raise InputError(f"{len(message.goals)} goals: at most {MOST_GOALS} are taken")
    if isinstance(message, Stroke) and not 1 <= len(message.points) <= MOST_POINTS:
        raise InputError(f"a stroke of {len(message.points)} points: 1 to {MOST_POINTS} are taken")
    return message
