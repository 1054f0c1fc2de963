"""Scenario files: a whole mission as TOML, read, checked and completed with its defaults."""
