"""One robot: election, formation, way-finding, tracking."""
