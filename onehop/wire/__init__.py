"""The wire format and the log: messages as bytes, their one order and digest, MCAP files."""
