"""One small script for each kind of fault: what tests of several levels run."""

SCRIPTS = {
    "kill": "{kind='kill', at_s=3, robots=[2]}",
    "stop": "{kind='stop', at_s=3, robots=[2, 3], duration_s=2}",
    "stop and continue": (
        "{kind='stop', at_s=3, robots=[2, 3]}, {kind='continue', at_s=5, robots=[2]},"
        " {kind='heal', at_s=7}"
    ),
    "stop, then kill and restart": (
        "{kind='stop', at_s=3, robots=[2, 3]}, {kind='kill', at_s=4, robots=[2]},"
        " {kind='restart', at_s=5, robots=[2, 3]}"
    ),
    "restart": "{kind='restart', at_s=3, robots=[2]}",
    "hold": "{kind='hold', at_s=3, robots=[2], duration_s=2}",
    "kidnap": "{kind='kidnap', at_s=3, robots=[2], x=30, y=30, heading_deg=90}",
    "blind": "{kind='blind', at_s=3, robots=[2], duration_s=3}",
    "slow": "{kind='slow', at_s=3, robots=[2, 3], duration_s=3, delay_ticks=10}",
    "cut": "{kind='cut', at_s=3, robots=[2], duration_s=3}",
    "cut one way": "{kind='cut', at_s=3, robots=[2], others=[3], direction='from', duration_s=3}",
    "corrupt": "{kind='corrupt', at_s=3, probability=0.5, duration_s=3}",
    "jam": "{kind='jam', at_s=3, x=8, y=8, radius=10, noise_dbm=-40, duration_s=3}",
    "heal": "{kind='cut', at_s=3, robots=[2]}, {kind='heal', at_s=5, robots=[2]}",
    "on an event": (
        "{kind='kill', on='leader elected'},"
        " {kind='stop', on='leader elected', nth=2, after_s=0.3, duration_s=1}"
    ),
}
"""Faults of the small scene (scenes.FIELD), as `--set faults=[...]` takes them."""
