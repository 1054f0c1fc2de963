"""The mission in real time: a schedule, the newest data, and nobody waits for anybody."""
