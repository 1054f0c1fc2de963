"""A search for the mission that breaks a promise: drawn by seed, judged from its log, made small."""
