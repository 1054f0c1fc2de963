"""What every process of a mission is: a session on the bus with an identity, tied to its launcher."""
