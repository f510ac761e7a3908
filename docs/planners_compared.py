"""Draws what each planner explores on the map of the office, for docs/how-to/which-planner.md."""

from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from dynastar import GridPlanner, PlannerConfig, load_map
from dynastar.io.examples import examples_folder
from dynastar.viewer import layers, palette
from dynastar.viewer.view import known_view

START, GOAL, RADIUS = (2.0, 2.0), (37.6, 22.6), 0.25  # m, as in examples/01_plan.py
PLANNERS = "dijkstra", "astar", "jump", "weighted", "improved"


def draw(path: Path) -> None:
    """Draws a panel for each planner: explored cells and path, with length and count."""
    grid = load_map(examples_folder() / "office" / "office.yaml")
    view = known_view(grid)
    figure = Figure(figsize=(10.5, 4.9), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    *panels, last = figure.subplots(2, 3).flat
    planner = GridPlanner(grid, RADIUS, config=PlannerConfig())
    for axes, name in zip(panels, PLANNERS, strict=True):
        found = planner.plan(START, GOAL, explored=True, planner=name)
        layers.show_map(axes, grid, view)
        if found.explored is not None:
            layers.show_explored(axes, found.explored, grid.frame, "")
        axes.plot(*found.path.points.T, color=palette.FIRST_PATH, linewidth=1.8)
        axes.plot(*zip(START, GOAL, strict=True), "o", color=palette.DRIVEN, markersize=4)
        axes.set(xticks=[], yticks=[])
        axes.set_title(f"{name}: {found.path.length:.1f} m, {found.expanded:,} expanded", size=9)
    last.axis("off")
    entries = [
        Patch(facecolor=palette.EXPLORED, label="expanded cells"),
        Line2D([], [], color=palette.FIRST_PATH, label="path, smoothed"),
        Line2D([], [], color=palette.DRIVEN, marker="o", linestyle="none", label="start and goal"),
    ]
    last.legend(handles=entries, loc="center", frameon=False, fontsize=9)
    figure.savefig(path)
