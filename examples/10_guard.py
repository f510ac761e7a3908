"""Guards two bad controllers: only commands pass after which the robot can still stop."""

import math

import numpy as np

from dynastar import Goal, Guard, Pose2D, Twist, World, load_scenario

scenario = load_scenario("goals")
limits, random = scenario.robot.limits, np.random.default_rng(1)


def straight(pose: Pose2D, goal: Goal) -> Twist:
    """Straight to the goal, whatever is in the way."""
    bearing = math.atan2(goal.y - pose.y, goal.x - pose.x) - pose.theta
    return Twist(limits.v_max, 2.0 * math.remainder(bearing, math.tau))


def policy(pose: Pose2D, goal: Goal) -> Twist:
    """A policy that has learnt nothing yet."""
    return Twist(random.uniform(0.0, limits.v_max), random.uniform(-1.0, 1.0))


print("controller  goal         alone     guarded")
for controller in (straight, policy):
    for goal in scenario.goals:
        ends = []
        for guard in (None, Guard(scenario.robot)):
            world, end = World(scenario), "stopped"
            while world.time < 20.0 and end == "stopped":
                command = controller(world.pose, goal)
                if guard is not None:
                    command = guard.filter(world.sensed_state(), world.scan(), command).command
                world.step(command, 0.1)
                arrived = math.dist(world.pose[:2], goal[:2]) < 0.25
                end = "arrived" if arrived else "contact" if world.contact else end
            ends.append(end)
        print(f"{controller.__name__:8}  ({goal.x:.1f}, {goal.y:.1f})  {ends[0]:>8}  {ends[1]:>10}")
