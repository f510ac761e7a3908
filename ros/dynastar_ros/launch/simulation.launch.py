"""Simulator, navigator and RViz: ros2 launch dynastar_ros simulation.launch.py scenario:=office.toml"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

SHARE = Path(get_package_share_directory("dynastar_ros"))


def generate_launch_description() -> LaunchDescription:
    """Both nodes for a scenario, and RViz with ``rviz:=true``."""
    scenario = LaunchConfiguration("scenario")
    return LaunchDescription(
        [
            DeclareLaunchArgument("scenario", description="a scenario file (.toml)"),
            DeclareLaunchArgument("rviz", default_value="false"),
            Node(
                package="dynastar_ros",
                executable="simulator",
                arguments=[scenario],
                output="screen",
            ),
            Node(
                package="dynastar_ros",
                executable="navigator",
                arguments=["--scenario", scenario],
                output="screen",
            ),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", str(SHARE / "rviz" / "dynastar.rviz")],
                condition=IfCondition(LaunchConfiguration("rviz")),
            ),
        ]
    )
