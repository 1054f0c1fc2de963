"""The two names of a station: the id of its robot, and its row in the tables of the medium."""

from typing import NewType

from onehop.contracts import messages

RobotId = NewType("RobotId", int)
"""A robot as messages, routes and the log name it, from 1 on."""

StationIndex = NewType("StationIndex", int)
"""A robot's place among the sorted ids of a mission, from 0 on: what DCF and medium count by."""

BROADCAST = RobotId(messages.BROADCAST)
"""Destination or next hop of a packet for everyone in range."""

EVERYONE = StationIndex(-1)
"""Receiver of the frame that carries such a packet."""
