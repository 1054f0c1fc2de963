"""A running team among ROS 2 nodes, by the wire of rmw_zenoh; needs no ROS. Nothing else imports it."""
