"""The navigator with a parameter file: ros2 launch dynastar_ros navigation.launch.py params_file:=..."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

SHARE = Path(get_package_share_directory("dynastar_ros"))


def generate_launch_description() -> LaunchDescription:
    """One node; topics are remapped by the arguments scan, odom and cmd_vel."""
    defaults = {
        "params_file": str(SHARE / "config" / "dynastar.yaml"),
        "use_sim_time": "false",
        "namespace": "",
        "scan": "scan",
        "odom": "odom",
        "cmd_vel": "cmd_vel",
    }
    arguments = [
        DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()
    ]
    node = Node(
        package="dynastar_ros",
        executable="navigator",
        name="dynastar",
        namespace=LaunchConfiguration("namespace"),
        output="screen",
        parameters=[
            LaunchConfiguration("params_file"),
            {"use_sim_time": LaunchConfiguration("use_sim_time")},
        ],
        remappings=[(topic, LaunchConfiguration(topic)) for topic in ("scan", "odom", "cmd_vel")],
    )
    return LaunchDescription([*arguments, node])
