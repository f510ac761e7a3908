"""Plans across the office with every planner and prints what each costs and finds.

Use "auto": it finds a shortest path on the grid. "improved" is the paper's A* (Eq. 2): its estimate is
too large, so it expands fewer cells than "astar", but may miss the shortest path, as it does here.
"""

from pathlib import Path

from dynastar import load_map, plan
from dynastar.planning import ALGORITHMS

grid = load_map(Path(__file__).parent / "office" / "office.yaml")
start, goal = (2.0, 2.0), (37.6, 22.6)
for planner in sorted(ALGORITHMS, key=lambda name: name != "auto"):
    found = [plan(grid, start, goal, planner, radius=0.25) for _ in range(2)][-1]  # 1st: compiles
    print(
        f"{planner:10} {found.path.length:6.2f} m smoothed, {found.grid_path.length:6.2f} m in "
        f"cells, {found.path.turns:2} turns, {found.expanded:6} expanded, {found.time_ms:6.1f} ms"
    )
