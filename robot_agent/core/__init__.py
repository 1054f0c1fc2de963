"""The pure part of a robot: `Robot.step(Percept) -> Action`."""
