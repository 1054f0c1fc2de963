"""Read a log: tables, timeline, figures, report, viewer layer, comparison, explanation."""

from onehop.analysis.log import Log, open_log

__all__ = ["Log", "open_log"]
