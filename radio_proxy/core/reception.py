"""How a station receives: preamble, lock, header, frame (802.11-1999, 15.2.7; thesis eq. 3.23).

A receiver that is free locks on a frame whose signal reaches the receive threshold above noise and jams,
and whose SINR is enough when its preamble has been detected. Locked, or while it transmits itself, it
receives nothing else: other frames are noise. The frame is then cut into stretches of constant
interference; PLCP header and MAC frame get through with the product of what each stretch lets through at
its rate. With capture a frame that is so much stronger takes over a receiver that still is in the
preamble of another.

A frame that overlaps no other needs none of this: it is one stretch, and a receiver that is free.
The rules are those of ns-3's YansWifiPhy and InterferenceHelper, the thresholds the scenario's.
"""

from collections.abc import Iterator
from itertools import pairwise

from onehop.contracts import elementary
from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import EVERYONE, StationIndex
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission, Judgement, Reception
from radio_proxy.core.error_rates import CERTAIN_SINR_DB, frame_success
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.link_rules import LinkRules
from radio_proxy.core.path_loss import SILENT_DB
from radio_proxy.core.propagation import Propagation

DETECTION = 4_000
"""Time from the start of a preamble until a receiver has detected it, as in ns-3 [ns]."""

SYNC = 144_000
"""Long PLCP preamble, during which a receiver can be captured (802.11-1999, 15.2.2) [ns]."""

PLCP = 192_000
"""Preamble and header; then PHY-RXSTART is indicated [ns]."""

HEADER_RATE_MBPS = 1.0
HEADER_BITS = 48
"""Rate and length of the long PLCP header (802.11-1999, 15.2.3)."""


class Receivers:
    """The receivers of all stations.

    locks_are_certain: who locks on a frame that overlaps no other receives it without bit errors.
    """

    def __init__(self, propagation: Propagation, draws: Draws, rules: LinkRules) -> None:
        budget = propagation.budget
        self._propagation = propagation
        self._draws = draws
        self._sigma_db = budget.shadowing_db
        self._threshold_db = budget.receive_threshold_db
        detectable_db = rules.preamble_sinr_db
        self._detectable_db = self._threshold_db if detectable_db is None else detectable_db
        self._capture_db = rules.capture_db
        self._stations = propagation.stations
        self._locked_on: dict[StationIndex, Emission] = {}
        self.locks_are_certain = self._threshold_db >= CERTAIN_SINR_DB

    def fade_db(self) -> float:
        """One draw of the log-normal fading [dB]."""
        return self._sigma_db * self._draws.normal() if self._sigma_db else 0.0

    # From begin to end of a frame.

    def overlap(self, emission: Emission, in_progress: list[Emission]) -> None:
        """A frame begins while others are in progress: each is noise to the others from now on."""
        now, source = emission.start, emission.source
        self.detect(in_progress, now)
        begun = emission.reception = Reception()
        for other in in_progress:
            reception = _reception(other)
            reception.overlaps.append(emission)
            reception.deaf.add(source)
            begun.overlaps.append(other)
            begun.deaf.add(other.source)
        self._release(source)
        for station, held in list(self._locked_on.items()):
            if self._is_captured(station, held, emission):
                self._release(station)
            elif self._is_held(station, held, now):
                begun.deaf.add(station)

    def detect(self, in_progress: list[Emission], now: int) -> None:
        """Who locks on the frames whose preambles have been detected by now."""
        for emission in in_progress:
            if emission.start + DETECTION <= now and _reception(emission).locked is None:
                self._lock(emission)

    def finish(self, emission: Emission, in_progress: list[Emission]) -> list[StationIndex]:
        """A frame that overlaps others has ended: judge it; returns who received it with errors."""
        self.detect(in_progress, emission.end)
        reception = _reception(emission)
        errors = []
        for station in reception.locked or ():
            if self._locked_on.get(station) is emission:
                del self._locked_on[station]
            judged = reception.judged[station] = self._judge_locked(emission, station)
            if judged[0] is not None and reception.headers[station]:
                errors.append(station)
        for station in self._stations if emission.receiver == EVERYONE else (emission.receiver,):
            if station != emission.source and station not in reception.judged:
                reception.judged[station] = self._judge_unlocked(emission, station)
        reception.overlaps.clear()
        return errors

    # What became of it.

    def judgement(self, emission: Emission, station: StationIndex) -> Judgement:
        """What kept a station from receiving a frame that has ended, and its lowest SINR [dB].

        A frame that nobody looked at yet overlaps no other, and a receiver was free for it.
        """
        reception, mean_db = emission.reception, emission.row[station]
        if reception is None:
            return self.judge_alone(station, mean_db, emission.fade_db)
        if station in reception.judged:
            return reception.judged[station]
        return self.judge_alone(station, mean_db, self._level_db(emission, station) - mean_db)

    def judge_alone(self, station: StationIndex, mean_db: float, fade_db: float | None) -> Judgement:
        """A frame that no other overlaps, at a receiver that is free; only where locks are certain."""
        if mean_db <= SILENT_DB:
            return DeliveryStatus.BELOW_THRESHOLD, SILENT_DB
        if fade_db is None:
            fade_db = self._sigma_db * self._draws.normal() if self._sigma_db else 0.0
        snr_db = mean_db + fade_db - self._propagation.noise_rise_db[station]
        return (None if snr_db >= self._threshold_db else DeliveryStatus.BELOW_THRESHOLD), snr_db

    def judge_overheard(
        self, station: StationIndex, mean_db: float, rate_mbps: float, bits: int
    ) -> Judgement:
        """A frame that another station received, at one that only listens, with a fading of its own."""
        cause, snr_db = self.judge_alone(station, mean_db, None)
        if cause is not None or snr_db >= CERTAIN_SINR_DB:
            return cause, snr_db
        success = frame_success(HEADER_RATE_MBPS, snr_db, HEADER_BITS)
        success *= frame_success(rate_mbps, snr_db, bits)
        return (None if self._survives(success) else DeliveryStatus.BIT_ERRORS), snr_db

    def has_received(self, emission: Emission, station: StationIndex) -> bool:
        """Whether a bystander received a frame that has ended."""
        reception = _reception(emission)
        if station not in reception.judged:
            if reception.locked is not None:
                return False
            reception.judged[station] = self.judgement(emission, station)
        return reception.judged[station][0] is None

    def has_started(self, emission: Emission, station: StationIndex, now: int) -> bool:
        """Whether PHY-RXSTART of a frame has been indicated to a station: it read its PLCP header."""
        if station == emission.source or now < emission.start + PLCP:
            return False
        if emission.end == NEVER:
            self.detect([emission], now)
        reception = _reception(emission)
        if reception.locked is None:
            level_db = self._level_db(emission, station)
            return level_db - self._propagation.noise_rise_db[station] >= self._threshold_db
        return station in reception.locked and self._reads_header(emission, station)

    def receiving(self, station: StationIndex, in_progress: list[Emission], now: int) -> Emission | None:
        """The frame in progress whose PLCP header a station has read."""
        for emission in in_progress:
            if self.has_started(emission, station, now):
                return emission
        return None

    # Preamble and lock.

    def _lock(self, emission: Emission) -> None:
        """Lock those for whom the signal is strong enough alone, and enough above its rivals."""
        detected = emission.start + DETECTION
        reception = _reception(emission)
        reception.locked = locked = []
        rivals = [other for other in reception.overlaps if other.end > detected]
        deaf, locked_on, rises_db = reception.deaf, self._locked_on, self._propagation.noise_rise_db
        for station, mean_db in zip(self._stations, emission.row, strict=True):
            if mean_db <= SILENT_DB or station in deaf or station in locked_on:
                continue
            level_db = self._level_db(emission, station)
            if level_db - rises_db[station] < self._threshold_db or station == emission.source:
                continue
            least_db = level_db - self._detectable_db
            for rival in rivals:
                if self._level_db(rival, station) > least_db:
                    break
            else:
                if not rivals or self._noise_db(station, rivals) <= least_db:
                    locked.append(station)
                    locked_on[station] = emission

    def _release(self, station: StationIndex) -> None:
        """A station gives up the frame that it is locked on."""
        held = self._locked_on.pop(station, None)
        if held is not None:
            locked = _reception(held).locked
            assert locked is not None
            locked.remove(station)

    def _is_captured(self, station: StationIndex, held: Emission, emission: Emission) -> bool:
        """Whether a new frame takes over a receiver that still is in the preamble of another."""
        if self._capture_db is None or emission.start >= held.start + SYNC:
            return False
        above_db = self._level_db(emission, station) - self._level_db(held, station)
        return above_db >= self._capture_db

    def _is_held(self, station: StationIndex, held: Emission, now: int) -> bool:
        """Whether a receiver still is locked on a frame: not, if it could not read its PLCP header."""
        if now < held.start + PLCP or self._reads_header(held, station):
            return True
        del self._locked_on[station]
        return False

    # Levels and stretches.

    def _level_db(self, emission: Emission, station: StationIndex) -> float:
        """Power of a frame at a station over the noise floor: mean and fading, drawn once."""
        levels_db = (emission.reception or _reception(emission)).levels_db
        level_db = levels_db.get(station)
        if level_db is None:
            level_db, fade_db = emission.row[station], emission.fade_db
            if fade_db is not None:
                level_db += fade_db
            elif level_db > SILENT_DB and self._sigma_db:
                level_db += self._sigma_db * self._draws.normal()
            levels_db[station] = level_db
        return level_db

    def _noise_db(self, station: StationIndex, others: list[Emission]) -> float:
        """Noise at a station over the floor, by jams and other frames."""
        noise = elementary.power_of_ten(self._propagation.noise_rise_db[station] / 10.0)
        for other in others:
            noise += elementary.power_of_ten(self._level_db(other, station) / 10.0)
        return 10.0 * elementary.log10(noise)

    def _stretches(
        self, emission: Emission, station: StationIndex, start: int, end: int
    ) -> Iterator[tuple[int, float]]:
        """Parts of a frame during which the same others overlap it: length [ns] and SINR [dB]."""
        overlaps = _reception(emission).overlaps
        edges = {start, end}
        for other in overlaps:
            edges.update(time for time in (other.start, other.end) if start < time < end)
        level_db = self._level_db(emission, station)
        for begin, stop in pairwise(sorted(edges)):
            others = [o for o in overlaps if o.start <= begin and o.end >= stop]
            yield stop - begin, level_db - self._noise_db(station, others)

    def _reads_header(self, emission: Emission, station: StationIndex) -> bool:
        headers = _reception(emission).headers
        if station not in headers:
            begin, end = emission.start + SYNC, emission.start + PLCP
            success = 1.0
            for length, sinr_db in self._stretches(emission, station, begin, end):
                success *= frame_success(HEADER_RATE_MBPS, sinr_db, HEADER_RATE_MBPS * length / 1000.0)
            headers[station] = self._survives(success)
        return headers[station]

    def _survives(self, success: float) -> bool:
        return success >= 1.0 or self._draws.uniform() < success

    # Judgements.

    def _judge_locked(self, emission: Emission, station: StationIndex) -> Judgement:
        """A collision is what the same draw would have let through without the others."""
        alone_db = self._level_db(emission, station) - self._noise_db(station, [])
        worst_db, success, rate_mbps = alone_db, 1.0, emission.rate_mbps
        for length, sinr_db in self._stretches(emission, station, emission.start + PLCP, emission.end):
            worst_db = min(worst_db, sinr_db)
            success *= frame_success(rate_mbps, sinr_db, rate_mbps * length / 1000.0)
        if not self._reads_header(emission, station):
            return (
                DeliveryStatus.COLLISION if worst_db < alone_db else DeliveryStatus.BIT_ERRORS,
                worst_db,
            )
        if success >= 1.0:
            return None, worst_db
        drawn = self._draws.uniform()
        if drawn < success:
            return None, worst_db
        collided = drawn < frame_success(rate_mbps, alone_db, emission.bits)
        return DeliveryStatus.COLLISION if collided else DeliveryStatus.BIT_ERRORS, worst_db

    def _judge_unlocked(self, emission: Emission, station: StationIndex) -> Judgement:
        """Its SINR is that under all frames that overlap it, together."""
        if emission.row[station] <= SILENT_DB:
            return DeliveryStatus.BELOW_THRESHOLD, SILENT_DB
        reception = _reception(emission)
        level_db = self._level_db(emission, station)
        sinr_db = level_db - self._noise_db(station, reception.overlaps)
        alone_db = level_db - self._propagation.noise_rise_db[station]
        if alone_db < self._threshold_db:
            return DeliveryStatus.BELOW_THRESHOLD, sinr_db
        if station in reception.deaf:
            return DeliveryStatus.RECEIVER_BUSY, sinr_db
        return DeliveryStatus.COLLISION, sinr_db


def _reception(emission: Emission) -> Reception:
    """The record of a frame at its receivers, from the first time that it matters."""
    if emission.reception is None:
        emission.reception = Reception()
    return emission.reception
