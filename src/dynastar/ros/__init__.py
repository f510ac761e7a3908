"""ROS 2: its messages to dynastar and back, nodes that need rclpy, recordings that need rosbags."""
