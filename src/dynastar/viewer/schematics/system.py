"""Fig. 8, the system plan that the paper names but does not show: the navigator as it is."""

import math
from itertools import pairwise
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from dynastar.viewer import palette
from dynastar.viewer.sheet import FINE, PAGE, SMALL, TEXT, bare, sheet

Points = tuple[tuple[float, float], ...]

HEIGHT = 4.28  # inches
PLAN_FACE, DRIVE_FACE, SENSE_FACE = palette.EXPLORED, "#f9e3da", "#d9efe8"


class Block(NamedTuple):
    """A box: its centre and size in inches, a title, what it does, and the module that does it."""

    x: float
    y: float
    width: float
    height: float
    face: str
    title: str
    does: str
    module: str

    @property
    def right(self) -> float:
        """Its right edge, inches."""
        return self.x + 0.5 * self.width

    @property
    def left(self) -> float:
        """Its left edge, inches."""
        return self.x - 0.5 * self.width

    @property
    def top(self) -> float:
        """Its upper edge, inches."""
        return self.y + 0.5 * self.height

    @property
    def low(self) -> float:
        """Its lower edge, inches."""
        return self.y - 0.5 * self.height


A, B, C = 3.77, 2.29, 0.76  # inches, the rows' middles
TALL = (0.88, 1.0, 1.0)  # inches, the rows' boxes
# fmt: off
BLOCKS = {
    "map": Block(0.58, A, 1.0, TALL[0], PLAN_FACE, "Map, goals",
                 "as loaded,\nas asked", "grid, io"),
    "planning map": Block(1.97, A, 1.24, TALL[0], PLAN_FACE, "Planning map",
                          "map and what was seen,\ninflated by the footprint",
                          "perception.planning_map\nclearance"),
    "search": Block(3.47, A, 1.2, TALL[0], PLAN_FACE, "Improved A*",
                    "Eqs. 2 and 3; an exact\nsearch a tick later", "planning.search\nplanning.heuristic"),
    "smooth": Block(4.86, A, 1.06, TALL[0], PLAN_FACE, "Smoothing",
                    "pulled taut,\ncorners rounded", "planning.smoothing"),
    "path": Block(6.22, A, 1.14, TALL[0], PLAN_FACE, "Global path",
                  "what is left of it\nfrom the robot on", "navigator.replanning"),
    "sensors": Block(0.58, B, 1.0, TALL[1], SENSE_FACE, "State, scans",
                     "each scan placed\nby its own stamp", "scan\nnavigator.sensing"),
    "senses": Block(1.97, B, 1.24, TALL[1], SENSE_FACE, "Perceive: View",
                    "local map, tracks,\npredictions, what may\nbe hidden",
                    "perception.tracking\nperception.prediction"),
    "recovery": Block(3.47, B, 1.2, TALL[1], PLAN_FACE, "Recovery",
                      "forget what was\nsensed, replan; in the\nend say \"blocked\"",
                      "navigator.recovery"),
    "watch": Block(4.86, B, 1.06, TALL[1], PLAN_FACE, "Route",
                   "path blocked? no\nprogress? a shorter\npath? at the goal?",
                   "navigator.replanning\nnavigator.progress"),
    "target": Block(6.22, B, 1.14, TALL[1], DRIVE_FACE, "Guidance",
                    "cost-to-go over the\nlocal map, from where\nthe path leaves it",
                    "guidance.travel_cost\nguidance.marching"),
    "robot": Block(0.58, C, 1.0, TALL[2], SENSE_FACE, "Robot",
                   "or a simulated\nworld", "robot\nsimulation"),
    "command": Block(1.97, C, 1.24, TALL[2], DRIVE_FACE, "Twist (v, ω)",
                     "the best; or the stop\nthat was certified",
                     "navigator.braking"),
    "dwa": Block(4.83, C, 3.92, TALL[2], DRIVE_FACE, "Dynamic window", "", ""),
}
# fmt: on
STAGES = (
    ("window", "Eqs. 5 and 6:\nspeeds in reach", "dwa.window"),
    ("rollouts", "Eq. 4: an arc, then\na tail", "dwa.motion\ndwa.rollout"),
    ("evaluation", "Eq. 9: heading, dist,\nvel, risk, nearness", "dwa.terms\ndwa.search"),
    ("certified stop", "Eq. 7: of the best\nthat can still brake", "dwa.admissible"),
)


def draw_system(width: float = PAGE) -> Figure:
    """The plan of the system: boxes of what is done by which module, arrows of what goes where."""
    figure = sheet(width, HEIGHT * width / PAGE)
    axes = bare(figure)
    axes.set(xlim=(0.0, PAGE), ylim=(0.0, HEIGHT))
    for block in BLOCKS.values():
        _show(axes, block)
    _show_stages(axes, BLOCKS["dwa"])
    _show_flow(axes)
    _show_feedback(axes)
    _say(axes, 0.1, 0.06, "solid: every tick", palette.INK, "left")
    _say(axes, 1.05, 0.06, "dashed: only when something is wrong", palette.DRIVEN, "left")
    return figure


def _show_flow(axes: Axes) -> None:
    """The data flow of a tick."""
    b = BLOCKS
    for left, right in pairwise(("map", "planning map", "search", "smooth", "path")):
        _arrow(axes, ((b[left].right, A), (b[right].left, A)))
    for upper, lower in (("path", "target"), ("target", "dwa")):
        _arrow(axes, ((b[upper].x, b[upper].low), (b[upper].x, b[lower].top)))
    for right, left in (("dwa", "command"), ("command", "robot")):
        _arrow(axes, ((b[right].left, C), (b[left].right, C)))
    for lower, upper in (("robot", "sensors"), ("senses", "planning map")):
        _arrow(axes, ((b[lower].x, b[lower].top), (b[lower].x, b[upper].low)))
    _arrow(axes, ((b["sensors"].right, B), (b["senses"].left, B)))
    _arrow(axes, ((b["target"].left, B), (b["watch"].right, B)))
    middle, into = 0.5 * (b["senses"].low + b["dwa"].top), b["dwa"].left + 0.2
    senses = b["senses"]
    _arrow(
        axes,
        ((senses.x, senses.low), (senses.x, middle), (into, middle), (into, b["dwa"].top)),
    )
    _say(axes, senses.x + 0.06, middle + 0.03, "free space, what moves", palette.INK, "left")
    _say(axes, senses.x + 0.06, senses.top + 0.2, "what was seen", palette.INK, "left")


def _show_feedback(axes: Axes) -> None:
    """The feedback on faults."""
    search, recovery, watch = (BLOCKS[k] for k in ("search", "recovery", "watch"))
    middle, at = 0.5 * (watch.top + search.low), 0.3
    _arrow(axes, ((watch.left, B), (recovery.right, B)), wrong=True)
    up: Points = ((watch.x, watch.top), (watch.x, middle))
    over: Points = ((search.x + at, middle), (search.x + at, search.low))
    _arrow(axes, (*up, *over), wrong=True)
    _say(axes, watch.x - 0.06, middle + 0.03, "replan", palette.DRIVEN, "right")
    x = recovery.x - at
    _arrow(axes, ((x, recovery.top), (x, search.low)), wrong=True)
    _say(
        axes, x - 0.06, 0.5 * (recovery.top + search.low) - 0.04, "replan", palette.DRIVEN, "right"
    )
    _arrow(axes, ((recovery.left, B), (BLOCKS["senses"].right, B)), wrong=True)
    _say(axes, recovery.left - 0.03, B + 0.05, "forget", palette.DRIVEN, "right")


def _say(axes: Axes, x: float, y: float, words: str, colour: str, ha: str) -> None:
    axes.text(x, y, words, fontsize=FINE, color=colour, ha=ha, va="bottom", zorder=4)


def _show(axes: Axes, block: Block) -> None:
    box = FancyBboxPatch(
        (block.left, block.low), block.width, block.height, boxstyle="round,pad=0,rounding_size=0.06",
        facecolor=block.face, edgecolor=palette.INK, linewidth=0.6, zorder=3,
    )  # fmt: skip
    axes.add_patch(box)
    axes.text(
        block.x, block.top - 0.07, block.title, fontsize=TEXT, fontweight="bold",
        color=palette.INK, ha="center", va="top", zorder=4,
    )  # fmt: skip
    axes.text(
        block.x, block.top - 0.25, block.does, fontsize=SMALL, color=palette.INK,
        ha="center", va="top", zorder=4, linespacing=1.15,
    )  # fmt: skip
    if block.module:
        _module(axes, block.x, block.low + 0.06, block.module)


def _module(axes: Axes, x: float, y: float, name: str) -> None:
    axes.text(
        x, y, name, fontsize=FINE, fontstyle="italic", color=palette.FAINT_INK,
        ha="center", va="bottom", zorder=4, linespacing=1.1,
    )  # fmt: skip


def _show_stages(axes: Axes, whole: Block) -> None:
    """The dynamic window's steps, side by side in its box."""
    step = whole.width / len(STAGES)
    for number, (name, does, module) in enumerate(STAGES):
        x = whole.left + (number + 0.5) * step
        style: dict[str, Any] = {
            "fontsize": SMALL,
            "color": palette.INK,
            "ha": "center",
            "va": "top",
            "zorder": 4,
        }
        axes.text(x, whole.top - 0.29, name, fontweight="bold", **style)
        axes.text(x, whole.top - 0.43, does, linespacing=1.15, **style)
        _module(axes, x, whole.low + 0.06, module)
        if number:
            begin, y = x - 0.5 * step, whole.top - 0.35
            _arrow(axes, ((begin - 0.06, y), (begin + 0.06, y)))


def _arrow(axes: Axes, points: Points, wrong: bool = False) -> None:
    """An arrow along points; ``wrong`` for what only comes when something is wrong."""
    colour = palette.DRIVEN if wrong else palette.INK
    line: Any = (0, (3, 1.5)) if wrong else "-"
    axes.plot(*zip(*points, strict=True), color=colour, linewidth=0.8, linestyle=line, zorder=2)
    (x0, y0), (x, y) = points[-2:]
    far = 0.01 / max(math.hypot(x - x0, y - y0), 1e-9)
    head: dict[str, Any] = {
        "arrowstyle": "-|>",
        "color": colour,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 6,
    }
    behind = (x + far * (x0 - x), y + far * (y0 - y))
    axes.annotate("", (x, y), xytext=behind, zorder=5, arrowprops={**head, "linewidth": 0.8})
