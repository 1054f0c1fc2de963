"""How a robot moves: from where it should be to a twist. The list of what has a say: robot_motion.py."""
