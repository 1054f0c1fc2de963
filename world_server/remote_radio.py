"""The radio as the world calls it: a truth goes out, and what it carried comes back."""

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.node.bus import Bus
from onehop.wire.batch import unpack_tick
from onehop.wire.journal import WireMessage
from world_server.mailbox import Mailbox, MissionBrokenError


class RemoteRadio:
    """The radio process. silence_s: how long it may take for a tick [s], on the wall clock."""

    def __init__(self, bus: Bus, mail: Mailbox, silence_s: float) -> None:
        self._mail = mail
        self._silence_s = silence_s
        self._put_truth = bus.publisher(topics.to(topics.RADIO, topics.TRUTH))
        self._answer: bytes | None = None
        mail.read(topics.RADIO, topics.CARRIED, self._on_carried)

    def send(self, truth: bytes) -> None:
        """Let it begin with a tick: an encoded Truth."""
        self._answer = None
        self._put_truth(truth)

    def carried(self, tick: int) -> list[WireMessage]:
        """Every inbox of the tick that it was sent, and its record. Raises MissionBrokenError."""
        if not self._mail.wait(lambda: self._answer is not None, self._silence_s):
            raise MissionBrokenError(f"the radio is silent for {self._silence_s:g} s")
        assert self._answer is not None
        try:
            answered, messages = unpack_tick(self._answer)
        except DecodeError as error:
            raise MissionBrokenError(f"the radio put no {error}") from None
        if answered != tick:
            raise MissionBrokenError(f"the radio answers for tick {answered}, not {tick}")
        return messages

    def _on_carried(self, data: bytes) -> None:
        self._answer = data
