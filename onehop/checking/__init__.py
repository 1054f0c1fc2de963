"""Judges a mission from its log alone: `judge(log)` tests every invariant of docs/checking.md.

Nothing here is shared with the programs that are judged but the messages (onehop/contracts) and the log
reader (onehop/wire): leader, shape, airtime, path loss and the faults that are in force are worked out
anew from their definitions. `lint-imports` holds that.
"""

from onehop.checking.invariants import INVARIANTS
from onehop.checking.judge import Report, judge

__all__ = ["INVARIANTS", "Report", "judge"]
