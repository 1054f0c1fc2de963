"""The pure part of the world: map, motion, laser, referee."""
