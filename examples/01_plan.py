"""Plans across the office with every planner and prints what each costs and finds."""

from pathlib import Path

from dynastar import load_map, plan
from dynastar.planning import PLANNERS

grid = load_map(Path(__file__).parent / "office" / "office.yaml")
start, goal = (2.0, 2.0), (37.6, 22.6)
for planner in PLANNERS:  # the first of all compiles, so each plans twice
    found = [plan(grid, start, goal, planner, radius=0.25) for _ in range(2)][-1]
    print(
        f"{planner:10} {found.path.length:6.2f} m smoothed, {found.grid_path.length:6.2f} m in "
        f"cells, {found.path.turns:2} turns, {found.expanded:6} expanded, {found.time_ms:6.1f} ms"
    )
