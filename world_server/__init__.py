"""Map, motion, laser range finder and clock: the ground truth."""
