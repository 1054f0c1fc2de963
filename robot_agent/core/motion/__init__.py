"""From where a robot should be to a twist: tracking, steering, borders, lanes, safety."""
