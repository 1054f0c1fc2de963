"""One attempt to send a frame, and what the layer above learns of it."""

from dataclasses import dataclass
from typing import Protocol

from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.contention import Frame, Station
from radio_proxy.core.emission import Emission, Judgement
from radio_proxy.core.nav import Reservation


class Listener(Protocol):
    """The layer above: what becomes of frames."""

    def on_service(self, sender: StationIndex, frame: Frame, now: int) -> None: ...
    def on_expired(self, sender: StationIndex, frame: Frame, now: int) -> None: ...
    def on_data_ended(
        self, sender: StationIndex, frame: Frame, emission: Emission, now: int
    ) -> None: ...
    def on_received(
        self, receiver: StationIndex, sender: StationIndex, frame: Frame, now: int
    ) -> None: ...
    def on_broadcast_done(
        self, sender: StationIndex, frame: Frame, emission: Emission, now: int
    ) -> None: ...
    def on_acknowledged(self, sender: StationIndex, frame: Frame, now: int) -> None: ...
    def on_undeliverable(self, sender: StationIndex, frame: Frame, now: int) -> None: ...


@dataclass(slots=True, eq=False)
class Exchange:
    """One attempt to send a frame. delay: of propagation [ns]. emission: its frame that was sent last.

    undisturbed: nobody can interfere with it. after_cts: its data follows a CTS. reservation: by its
    RTS. judged: frames that were judged before they end.
    """

    sender: Station
    receiver: Station
    frame: Frame
    delay: int
    emission: Emission
    undisturbed: bool = False
    after_cts: bool = False
    reservation: Reservation | None = None
    judged: tuple[Judgement, ...] = ()
