"""What the card of each robot hears of all others: SNR and power of frames, for it or not.

Frames that name their sender count: data and packets of routing. RTS, CTS and ACK do not: the last two
carry no address of who sends them (802.11-1999, 7.2.1), and after an RTS comes its data.

The addressee of a frame, all of a broadcast, and whoever is locked on a frame that overlaps others are
judged by the medium. For everybody else a frame is judged here, with fading and bit errors out of a
stream of its own: nothing that the medium draws depends on whether somebody listens.
"""

from collections.abc import Iterable

from onehop.contracts.messages import DeliveryStatus
from onehop.contracts.neighbour import Neighbour
from radio_proxy.core.addresses import RobotId, StationIndex
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission, Judgement
from radio_proxy.core.link_rules import LinkRules
from radio_proxy.core.path_loss import OWN_DB, SILENT_DB
from radio_proxy.core.propagation import Propagation
from radio_proxy.core.reception import Receivers


class Eavesdropper:
    """Collects what the cards of a mission hear. draws: of its own. robots: in order of stations."""

    def __init__(
        self, robots: tuple[RobotId, ...], propagation: Propagation, rules: LinkRules, draws: Draws
    ) -> None:
        self._robots = robots
        self._propagation = propagation
        self._own = Receivers(propagation, draws, rules)
        self._floor_dbm = propagation.budget.noise_dbm
        self._heard: dict[int, dict[int, Neighbour]] = {}

    def on_frame(
        self, emission: Emission, judged: Judgement | None, listening: Iterable[RobotId], now: int
    ) -> None:
        """A frame has ended. judged: at its addressee; None for a broadcast, which all were judged for.

        listening: robots whose cards are up.
        """
        up = frozenset(listening)
        for station, robot in enumerate(self._robots):
            if robot not in up or station == emission.source:
                continue
            index = StationIndex(station)
            if judged is not None and index == emission.receiver:
                verdict = judged
            else:
                verdict = self._judge(emission, index)
            if verdict[0] is None:
                self._hear(emission, index, robot, verdict[1], now)

    def heard(self, robot: int) -> tuple[Neighbour, ...]:
        """What a robot's card has heard since it was last asked, by id of the neighbour."""
        return tuple(one for _, one in sorted(self._heard.pop(robot, {}).items()))

    def forget(self, robot: int) -> None:
        """A robot has left, or is another process."""
        self._heard.pop(robot, None)

    def _judge(self, emission: Emission, station: StationIndex) -> Judgement:
        """What kept a bystander from hearing a frame (None: nothing), and its SNR [dB]."""
        reception, mean_db = emission.reception, emission.row[station]
        if reception is not None and station in reception.judged:
            return reception.judged[station]
        if not SILENT_DB < mean_db < OWN_DB:
            return DeliveryStatus.BELOW_THRESHOLD, SILENT_DB
        if reception is not None and reception.locked is not None:
            return DeliveryStatus.RECEIVER_BUSY, SILENT_DB  # others overlapped it, and it was not locked
        return self._own.judge_overheard(station, mean_db, emission.rate_mbps, emission.bits)

    def _hear(
        self, emission: Emission, station: StationIndex, robot: RobotId, snr_db: float, now: int
    ) -> None:
        """Keep the last frame of each neighbour. Its power is that of the level the medium drew."""
        levels_db = emission.reception.levels_db if emission.reception is not None else {}
        level_db = levels_db.get(station)
        if level_db is None:
            level_db = snr_db + self._propagation.noise_rise(station)
        source = self._robots[emission.source]
        mine = self._heard.setdefault(robot, {})
        frames = 1 + (mine[source].frames if source in mine else 0)
        mine[source] = Neighbour(source, snr_db, level_db + self._floor_dbm, now, frames)
