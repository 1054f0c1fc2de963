"""Many missions: on all cores or on a cluster, every one a line of a file."""
