"""Lays keep-out zones and speed limits over a map, as Nav2's costmap filters do."""

from pathlib import Path

from dynastar import Goal, Scenario, load_map, plan, run
from dynastar.masks import SpeedScale, with_keepout, with_speed_limits
from dynastar.metrics import measure
from dynastar.robot import ROBOTS

FOLDER = Path(__file__).parent / "features"
robot = ROBOTS["pioneer3dx"]
hall = load_map(FOLDER / "hall.yaml")
closed = with_keepout(hall, load_map(FOLDER / "keepout.yaml"))
slow = with_speed_limits(hall, load_map(FOLDER / "speed.yaml"), robot.limits.v_max, SpeedScale())

start, goal = (1.5, 1.5), (12.5, 1.5)
for name, grid in (("no mask", hall), ("keep-out zone", closed)):
    path = plan(grid, start, goal, radius=0.25, unknown="free").path
    print(f"{name}: {path.length:.1f} m")
for name, grid in (("no mask", hall), ("speed limit", slow)):
    result = measure(run(Scenario(name, grid, robot, (*start, 0.0), (Goal(*goal),))))
    print(f"{name}: {result.outcome} after {result.time:.1f} s")
