"""Way-finding: from laser scans to a twist that brings a leader to its goal."""
