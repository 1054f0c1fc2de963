"""A log as a rosbag2 folder: what `ros2 bag`, rviz2, PlotJuggler and Foxglove open. Needs no ROS."""
