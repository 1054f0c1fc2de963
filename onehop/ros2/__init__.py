"""A running team among ROS 2 nodes, by the wire of rmw_zenoh; needs no ROS."""

DEFAULT_ROUTER = "tcp/127.0.0.1:7447"
"""Where nodes look for the router of rmw_zenoh by default."""
