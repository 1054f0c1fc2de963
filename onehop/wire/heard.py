"""What a robot has heard in real time, message by message, as the one inbox of a step."""

from collections.abc import Iterable

from msgspec.structs import replace

from onehop.contracts.messages import Heard, Inbox
from onehop.contracts.neighbour import Neighbour


def inbox_of(tick: int, time_ns: int, heard: Iterable[Heard]) -> Inbox:
    """The inbox for the observation of a tick. Of several reports of a neighbour the last one counts,
    with the frames of all of them."""
    messages = list(heard)
    neighbours: dict[int, Neighbour] = {}
    for message in messages:
        for one in message.neighbours:
            before = neighbours.get(one.robot)
            frames = one.frames + (before.frames if before is not None else 0)
            neighbours[one.robot] = replace(one, frames=frames)
    return Inbox(
        tick=tick,
        time_ns=time_ns,
        receptions=tuple([one.reception for one in messages if one.reception is not None]),
        neighbours=tuple([neighbours[robot] for robot in sorted(neighbours)]),
        heard=tuple([one.number for one in messages]),
    )
