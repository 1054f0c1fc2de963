"""`radio-integrity`: every reception has one verdict, every verdict one message, every message its time.

Messages are counted as the radio counts them: the n-th that a robot hands over is its message n. Behind
ticks that the log lacks the count is found again from the first verdict that fits one message alone.
"""

from dataclasses import dataclass, field

from onehop.checking.airtime import Airtimes
from onehop.checking.findings import Exhibit, Findings
from onehop.checking.invariants import RADIO_INTEGRITY
from onehop.checking.snapshot import ARRIVES, Snapshot
from onehop.contracts import topics
from onehop.contracts.messages import (
    BROADCAST,
    DeliveryStatus,
    RadioRecord,
    Reception,
    Transmission,
    Truth,
    Verdict,
)
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.sections import ClockSection


@dataclass(frozen=True, slots=True)
class _Sent:
    """A message that was handed over. sent: with its payload. offered_ns: when."""

    sent: Transmission
    offered_ns: int
    tick: int

    @property
    def msdu_bytes(self) -> int:
        return max(self.sent.msdu_bytes, len(self.sent.payload))


@dataclass(slots=True)
class _Source:
    """Messages of one robot that have no verdict yet, by their place since known_ns.

    first: number of the message at place 0, None while it is not known. known_ns: what was offered
    before is not known.
    """

    first: int | None
    known_ns: int
    count: int = 0
    unsettled: dict[int, _Sent] = field(default_factory=dict)

    def place(self, verdict: Verdict) -> int | None:
        """Where the message of a verdict stands; None if that cannot be known."""
        if verdict.offered_ns < self.known_ns:
            return None
        if self.first is None:
            fitting = [
                place
                for place, one in self.unsettled.items()
                if (one.offered_ns, one.sent.destination) == (verdict.offered_ns, verdict.destination)
            ]
            if len(fitting) != 1:
                return None
            self.first = verdict.message - fitting[0]
        return verdict.message - self.first


@dataclass(frozen=True, slots=True)
class _Awaited:
    """A message that arrived. payload: as it was sent, None if that is not known."""

    verdict: Verdict
    payload: bytes | None

    def is_of(self, reception: Reception) -> bool:
        verdict = self.verdict
        return (reception.source, reception.arrival_ns) == (verdict.source, verdict.arrival_ns)

    def wrong_content(self, reception: Reception) -> str | None:
        """What a reception says otherwise than the verdict on its message."""
        verdict = self.verdict
        is_altered = self.payload is not None and reception.payload != self.payload
        if is_altered and verdict.status is not DeliveryStatus.CORRUPTED:
            return "is altered"
        if verdict.status is DeliveryStatus.CORRUPTED and reception.payload == self.payload:
            return "is said to be altered, and is not"
        account = Reception(
            source=verdict.source,
            payload=reception.payload,
            service_start_ns=verdict.service_start_ns,
            arrival_ns=verdict.arrival_ns,
            hops=len(verdict.path) - 1,
            attempts=sum(verdict.attempts),
            snr_db=verdict.snr_db,
            bit_error_rate=verdict.bit_error_rate,
            msdu_bytes=verdict.msdu_bytes,
        )
        return None if account == reception else "is received otherwise than its verdict says"


class RadioIntegrity:
    """Follows every message from the truth that offers it to the inbox that gets it."""

    def __init__(self, findings: Findings, radio: RadioSection, clock: ClockSection) -> None:
        self._findings = findings
        self._airtimes = Airtimes(radio)
        self._period_ns = clock.period_ns
        self._in_real_time = clock.is_realtime
        self._handed: frozenset[int] = frozenset()
        self._known_ns: int | None = None
        self._sources: dict[int, _Source] = {}
        self._awaited: dict[int, list[_Awaited]] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if now.tick > 0 and not now.follows:
            self._lose_count((now.tick - 1) * self._period_ns)
        if now.truth is None or now.record is None:
            self._lose_count(now.tick * self._period_ns)
            return
        for departure in now.truth.departures:
            self._awaited.pop(departure.robot, None)
        if self._in_real_time:
            self._take_offers(now, now.truth, now.record)
        else:
            self._take_requests(now.truth)
        self._judge_verdicts(now, now.record)

    def _lose_count(self, known_ns: int) -> None:
        """Of messages that were offered before known_ns nothing is known any more."""
        self._known_ns = known_ns
        self._sources, self._awaited = {}, {}

    def _source(self, robot: int) -> _Source:
        source = self._sources.get(robot)
        if source is None:
            source = _Source(1, 0) if self._known_ns is None else _Source(None, self._known_ns)
            self._sources[robot] = source
        return source

    def _take_requests(self, truth: Truth) -> None:
        offered_ns = truth.time_ns - self._period_ns
        for request in truth.transmit_requests:
            if not request.outbox:
                continue
            self._offer(request.robot, request.outbox, offered_ns, truth.tick)

    def _take_offers(self, now: Snapshot, truth: Truth, record: RadioRecord) -> None:
        """In real time: what the truth brings and was not handed over before, and what was at once."""
        intake = record.intake
        if intake is None:
            what = "the record does not tell when its truth came"
            said = now.exhibit(topics.RADIO_RECORD, "no intake")
            self._findings.report(RADIO_INTEGRITY, now.tick, (), what, said)
            return
        for request in truth.transmit_requests:
            if request.robot not in self._handed:
                self._offer(request.robot, request.outbox, intake.placed_ns, truth.tick)
        for one in intake.handed:
            action = now.actions.get(one.robot)
            if action is not None:
                self._offer(one.robot, action.outbox, one.at_ns, truth.tick)
        self._handed = frozenset(one.robot for one in intake.handed)

    def _offer(self, robot: int, outbox: tuple[Transmission, ...], offered_ns: int, tick: int) -> None:
        source = self._source(robot)
        for sent in outbox:
            source.unsettled[source.count] = _Sent(sent, offered_ns, tick)
            source.count += 1

    def _judge_verdicts(self, now: Snapshot, record: RadioRecord) -> None:
        settled: dict[tuple[int, int], set[int]] = {}
        for verdict in record.verdicts:
            self._findings.count(RADIO_INTEGRITY)
            source = self._source(verdict.source)
            place = source.place(verdict)
            if place is None:
                self._await(verdict, None)
                continue
            sent = source.unsettled.get(place)
            receivers = settled.setdefault((verdict.source, place), set())
            if sent is None:
                never = place >= source.count or place < 0
                self._report(now, verdict, "was never sent" if never else "was settled already")
            elif verdict.receiver in receivers:
                self._report(now, verdict, "has two verdicts for one receiver", _sending(sent, verdict))
            else:
                receivers.add(verdict.receiver)
                self._judge(now, verdict, sent)
                if verdict.status in ARRIVES:
                    self._await(verdict, sent.sent.payload)
        for robot, place in settled:
            self._sources[robot].unsettled.pop(place, None)
        self._judge_receptions(now)

    def _await(self, verdict: Verdict, payload: bytes | None) -> None:
        """A message that arrives comes into an inbox. payload: None if it is not known."""
        if verdict.status in ARRIVES:
            self._awaited.setdefault(verdict.receiver, []).append(_Awaited(verdict, payload))

    def _judge(self, now: Snapshot, verdict: Verdict, sent: _Sent) -> None:
        """One verdict against the message that it is about."""
        wrong = self._wrong_account(verdict, sent)
        if wrong is None and verdict.status in ARRIVES:
            wrong = self._wrong_delivery(now, verdict)
        if wrong is not None:
            self._report(now, verdict, wrong, _sending(sent, verdict))

    @staticmethod
    def _wrong_account(verdict: Verdict, sent: _Sent) -> str | None:
        is_broadcast = sent.sent.destination == BROADCAST
        if verdict.destination != sent.sent.destination:
            return f"was for robot {sent.sent.destination}, not {verdict.destination}"
        if verdict.msdu_bytes != sent.msdu_bytes:
            return f"had {sent.msdu_bytes} bytes, not {verdict.msdu_bytes}"
        if verdict.offered_ns != sent.offered_ns:
            return f"was offered at {sent.offered_ns} ns, not {verdict.offered_ns}"
        if (
            verdict.receiver == verdict.source
            if is_broadcast
            else verdict.receiver != verdict.destination
        ):
            return f"was not for robot {verdict.receiver}"
        return None

    def _wrong_delivery(self, now: Snapshot, verdict: Verdict) -> str | None:
        path, hops = verdict.path, len(verdict.path) - 1
        if hops < 1 or (path[0], path[-1]) != (verdict.source, verdict.receiver):
            return f"came by the way {' '.join(map(str, path))}"
        if len(verdict.attempts) != hops or min(verdict.attempts) < 1:
            return f"took {hops} hops in attempts {' '.join(map(str, verdict.attempts))}"
        is_broadcast = verdict.destination == BROADCAST
        least_ns = self._airtimes.message_ns(verdict.msdu_bytes, is_broadcast, hops)
        took_ns = verdict.arrival_ns - max(verdict.service_start_ns, verdict.offered_ns)
        if took_ns < least_ns:
            return f"arrived after {took_ns / 1e6:g} ms; its airtime alone is {least_ns / 1e6:g} ms"
        begin_ns, end_ns = self._span(now)
        if not begin_ns <= verdict.arrival_ns <= end_ns:
            return f"arrived at {verdict.arrival_ns} ns, which is not in this tick"
        if verdict.status is DeliveryStatus.CORRUPTED and not _is_corrupted(now, verdict.receiver):
            return "is altered, and no corruption is in force"
        return None

    def _span(self, now: Snapshot) -> tuple[int, int]:
        """From when to when the record of a tick goes [ns]."""
        if now.record is not None and now.record.intake is not None and self._in_real_time:
            return now.record.intake.placed_ns, now.record.intake.until_ns
        end_ns = now.tick * self._period_ns
        return end_ns - self._period_ns, end_ns

    def _judge_receptions(self, now: Snapshot) -> None:
        """Inboxes hold what arrived: each once, as it was sent, and nothing else."""
        for robot, inbox in now.inboxes.items():
            awaited = self._awaited.get(robot, [])
            for reception in inbox.receptions:
                mine = next((one for one in awaited if one.is_of(reception)), None)
                if mine is None:
                    what = f"robot {robot} got a message of robot {reception.source} that did not arrive"
                    self._report_reception(now, robot, reception, what)
                    continue
                awaited.remove(mine)
                wrong = mine.wrong_content(reception)
                if wrong is not None:
                    what = f"a message of robot {reception.source} to robot {robot} {wrong}"
                    self._report_reception(now, robot, reception, what)
            if self._in_real_time:  # what is left it reads later; what came before it has passed over
                last_ns = max((one.arrival_ns for one in inbox.receptions), default=0)
                self._awaited[robot] = [one for one in awaited if one.verdict.arrival_ns >= last_ns]
                continue
            for one in awaited:
                self._report(now, one.verdict, "arrived and is not in the inbox")
        if self._in_real_time:
            return
        # who is stopped reads it later, and who is gone never
        self._awaited = {i: self._awaited[i] for i in now.stopped if i in self._awaited}

    def _report_reception(self, now: Snapshot, robot: int, reception: Reception, what: str) -> None:
        says = f"from robot {reception.source}, arrived at {reception.arrival_ns} ns"
        robots = (reception.source, robot)
        said = now.exhibit(topics.rx(robot), says)
        self._findings.report(RADIO_INTEGRITY, now.tick, robots, what, said)

    def _report(self, now: Snapshot, verdict: Verdict, what: str, *evidence: Exhibit) -> None:
        name = f"message {verdict.message} of robot {verdict.source}"
        says = f"{name} to robot {verdict.receiver}: {verdict.status.value}"
        self._findings.report(
            RADIO_INTEGRITY, now.tick, (verdict.source, verdict.receiver), f"{name} {what}",
            now.exhibit(topics.RADIO_RECORD, says), *evidence,
        )  # fmt: skip


def _sending(sent: _Sent, verdict: Verdict) -> Exhibit:
    to = "everyone" if sent.sent.destination == BROADCAST else f"robot {sent.sent.destination}"
    says = f"robot {verdict.source} to {to}, {sent.msdu_bytes} bytes"
    return Exhibit(sent.tick, topics.wire(topics.TRUTH), says)


def _is_corrupted(now: Snapshot, robot: int) -> bool:
    """Whether a fault may alter what a robot receives in this tick."""
    return now.truth is not None and any(robot in one.robots for one in now.truth.corruptions)
