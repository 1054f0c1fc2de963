"""The ways to run the cores without a bus: in one process, from a log, one planner alone."""
