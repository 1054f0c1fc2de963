"""What every part agrees on: messages, topics, geometry, scenario, errors. A pure leaf."""
