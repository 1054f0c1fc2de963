"""Read a log: summary, figures, comparison."""
