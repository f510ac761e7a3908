"""Running the nodes: until SIGINT or SIGTERM, with zero velocity as the last word."""

import signal
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from dynastar.errors import ConfigError
from dynastar.simulation import warm_up


def navigate(arguments: Sequence[str]) -> int:
    """Runs the navigator's node; ``arguments`` are ROS's own (``--ros-args ...``)."""
    from dynastar.ros.node import NavigatorNode

    warm_up()
    return run(NavigatorNode, arguments)


def guard(arguments: Sequence[str]) -> int:
    """Runs the guard's node."""
    from dynastar.ros.guard_node import GuardNode

    warm_up()
    return run(GuardNode, arguments)


def simulate(scenario: Any, arguments: Sequence[str]) -> int:
    """Runs the simulator's node with a scenario."""
    from dynastar.ros.sim_node import SimulatorNode

    warm_up()
    return run(lambda: SimulatorNode(scenario), arguments)


def run(make: Callable[[], Node], arguments: Sequence[str]) -> int:
    """Spins a node until a signal ends it; 0."""
    stopping: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup has it for SIGHUP
            signal.signal(number, lambda number, frame: stopping.append(number))
    try:
        rclpy.init(args=list(arguments), signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:  # what rclpy's own errors are
        raise ConfigError(
            f"ROS cannot read its arguments: {' '.join(str(error).split())}"
        ) from None
    node = None
    executor = SingleThreadedExecutor()
    try:
        node = make()
        executor.add_node(node)
        while not stopping and rclpy.ok():
            executor.spin_once(timeout_sec=0.1)
    finally:
        if node is not None and hasattr(node, "stop"):
            node.stop()
        executor.shutdown()
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0
