"""ROS 2: the navigator and the simulator as nodes. Nothing here is imported without rclpy."""
