"""The colcon package of dynastar's nodes."""

from glob import glob

from setuptools import setup

NAME = "dynastar_ros"

setup(
    name=NAME,
    version="0.2.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        *(
            (f"share/{NAME}/{folder}", glob(f"{folder}/*"))
            for folder in ("launch", "config", "rviz")
        ),
    ],
    install_requires=["setuptools", "dynastar"],
    entry_points={
        "console_scripts": [
            "navigator = dynastar_ros:navigator",
            "simulator = dynastar_ros:simulator",
            "guard = dynastar_ros:guard",
        ]
    },
)
