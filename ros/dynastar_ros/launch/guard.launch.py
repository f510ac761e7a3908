"""The guard with a parameter file: ros2 launch dynastar_ros guard.launch.py cmd_vel_in:=/joy_vel"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

SHARE = Path(get_package_share_directory("dynastar_ros"))


def generate_launch_description() -> LaunchDescription:
    """One node; topics are remapped by the arguments scan, odom, cmd_vel_in and cmd_vel."""
    defaults = {
        "params_file": str(SHARE / "config" / "guard.yaml"),
        "use_sim_time": "false",
        "namespace": "",
        "scan": "scan",
        "odom": "odom",
        "cmd_vel_in": "cmd_vel_in",
        "cmd_vel": "cmd_vel",
    }
    arguments = [
        DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()
    ]
    node = Node(
        package="dynastar_ros",
        executable="guard",
        name="dynastar_guard",
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        parameters=[
            LaunchConfiguration("params_file"),
            {"use_sim_time": LaunchConfiguration("use_sim_time")},
        ],
        remappings=[
            (topic, LaunchConfiguration(topic))
            for topic in ("scan", "odom", "cmd_vel_in", "cmd_vel")
        ],
    )
    return LaunchDescription([*arguments, node])
