"""Questions to many missions: every combination of some keys, and by how much they differ.

from onehop import study

missions = study.sweep("scenarios/map1.toml", {"gains.k_rho_min": [0.1, 0.3]}, out="runs/gains")
missions.cells()  # means and 95 % intervals
missions.differences()  # what changes from the first value, seed by seed
chapter4 = study.thesis(out="runs/thesis")  # chapter 4 of the thesis again
phase = study.policies("scenarios/thesis/map1.toml", out="runs/policies")  # where a policy matters
"""

from onehop.study.calls import policies, thesis
from onehop.study.sweeping import sweep
from onehop.study.table import Missions

__all__ = ["Missions", "policies", "sweep", "thesis"]
