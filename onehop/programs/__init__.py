"""The programs of robots: found by name, given their parameters, asked for each tick, and mistrusted."""
