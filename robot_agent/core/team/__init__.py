"""The team protocol: rosters, modes, messages, and what each robot owes the others."""
