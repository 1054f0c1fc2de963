"""The ways to run the cores: in one process, over Zenoh, from a log."""
