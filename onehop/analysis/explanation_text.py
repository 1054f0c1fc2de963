"""An explanation in sentences, for people."""

from collections.abc import Iterator
from typing import Any

from onehop.analysis.explanation import Explanation, Since
from onehop.analysis.message_traces import MessageTrace
from onehop.analysis.payloads import summary_of
from onehop.contracts.messages import DeliveryStatus
from onehop.contracts.printable import ids_in_words, in_words, printable

MOST_LINES = 200
"""Events and messages that are listed, the last ones: a robot can send thousands in a second."""

LEAST_SNR_DB = -50.0
"""Below it nothing was received to speak of: out of all reach, cut off, or drowned by its own frame."""

WHY_LOST = {
    DeliveryStatus.CORRUPTED: "it arrived with other bytes than were sent, and was refused",
    DeliveryStatus.BELOW_THRESHOLD: "the signal was too weak: distance, a wall, a cut link or a jammer",
    DeliveryStatus.BIT_ERRORS: "received, but with bit errors",
    DeliveryStatus.COLLISION: "another frame was sent at the same time and drowned it",
    DeliveryStatus.RECEIVER_BUSY: "the receiver was busy with another frame, or reserved (NAV)",
    DeliveryStatus.NO_ROUTE: "no route through the team was found",
    DeliveryStatus.QUEUE_FULL: "the queue of the robot that was to send it was full",
    DeliveryStatus.EXPIRED: "it waited for a route or for the medium until it was of no use any more",
    DeliveryStatus.RECEIVER_GONE: "the receiver has left the mission",
    DeliveryStatus.RELAY_GONE: "a robot that was to pass it on has left the mission",
    DeliveryStatus.SENDER_GONE: "the sender left the mission before it was sent",
}
"""What each delivery status of a lost message means, in plain words."""


def explanation_text(one: Explanation) -> Iterator[str]:
    """Lines of text: what the robot is doing, why, and which messages it got and sent."""
    yield f"Robot {one.robot} at {one.at_s:.2f} s (tick {one.tick})"
    if one.left is not None:
        yield f"  It left at {one.left['at_s']:.2f} s: {one.left['why']}. What follows is its last tick."
    yield from (f"  {line}" for line in _state(one))
    yield from (f"  fault in force: {fault}" for fault in one.faults)
    yield ""
    yield "Events before it"
    yield from _last_of([_event(event) for event in one.events[-MOST_LINES - 1 :]], len(one.events))
    yield ""
    yield "Messages to it and from it"
    groups = _messages(one)
    lines = [_message_line(group, one.robot) for group in groups[-MOST_LINES - 1 :]]
    yield from _last_of(lines, len(groups))


def _last_of(lines: list[str], number: int) -> Iterator[str]:
    """The last lines of so many."""
    if not lines:
        yield "  none"
    if number > MOST_LINES:
        yield f"  {number - MOST_LINES} earlier ones (--json has them)"
    yield from lines[-MOST_LINES:]


def _state(one: Explanation) -> Iterator[str]:
    for name, value in one.values.items():
        yield f"shows    {printable(name)} {value:z.3f}"
    if one.mode is not None and one.roster is not None:
        yield from _team_state(one, one.mode, one.roster)
    elif one.pose:
        x, y, v, w = (one.pose[key] for key in ("x", "y", "v", "w"))
        yield f"moves    at ({x:.2f}, {y:.2f}) m with v {v:z.2f} m/s, w {w:z.2f} rad/s; it has no team"


def _team_state(one: Explanation, mode: Since, since: Since) -> Iterator[str]:
    status, roster = one.status, since.value
    change = one.mode_change
    why = ", from the start"
    if change is not None:
        why = f", on {_said(change, 'on')!r}, before that {_said(change, 'was')}"
    yield f"mode     {mode.value} since {mode.since_s:.2f} s{why}"
    members = ids_in_words(roster["members"]) or "nobody"
    whom = "itself" if roster["leader"] == one.robot else f"robot {roster['leader']}"
    yield (
        f"roster   obeys {whom}: epoch {roster['epoch']}, members {members}, {roster['shape']}, "
        f"since {since.since_s:.2f} s"
    )
    yield from _gain(one, roster["leader"])
    if one.pose:
        stands = f"stands at ({one.pose['x']:.2f}, {one.pose['y']:.2f}) m"
        aim = "goal" if roster["leader"] == one.robot else "slot"
        yield (
            f"error    {status['error']:.2f} m to its {aim}; {stands}, heads for "
            f"({status['target_x']:.2f}, {status['target_y']:.2f}) m"
        )
        yield f"command  v {status['v']:z.2f} m/s, w {status['w']:z.2f} rad/s"


def _gain(one: Explanation, leader: int) -> Iterator[str]:
    status, gains = one.status, one.gains
    if leader == one.robot:
        yield f"k_rho    {status['k_rho']:g} 1/s: a leader follows nobody"
        return
    measured, threshold = status["throughput_bps"], status["threshold_bps"]
    if measured <= 0:
        reason = "a Next is missing, which counts as throughput 0"
    else:
        relation = "below" if measured < threshold else "at or above"
        reason = (
            f"the last Next came with {measured / 1e3:.0f} kb/s, {relation} the threshold "
            f"{threshold / 1e3:.0f} kb/s"
        )
    if gains.policy == "constant":
        reason = f"policy constant ({reason})"
    since = "" if one.k_rho is None else f" since {one.k_rho.since_s:.2f} s"
    yield f"k_rho    {status['k_rho']:.2f} 1/s{since}: {reason}"
    if one.next_s is None:
        yield "leader   never heard a command of this leader"
    else:
        yield (
            f"leader   last command at {one.next_s:.3f} s, {one.at_s - one.next_s:.2f} s before; "
            f"one is due every {one.team.next_period:g} s, and after {one.team.leader_timeout:g} s "
            "without one it gives the leader up"
        )


def _said(data: dict[str, Any], key: str) -> str:
    """What a note says under a key: a robot can leave it out, or put anything there."""
    return in_words(data.get(key, "?"))


def _event(event: dict[str, Any]) -> str:
    if event["kind"] == "mode":
        change = f"{_said(event, 'was')} -> {_said(event, 'mode')}, on {_said(event, 'on')!r}"
        return f"  {event['at_s']:8.2f} s  mode: {change}"
    details = ", ".join(
        f"{printable(key)} {_said(event, key)}" for key in event if key not in ("at_s", "kind")
    )
    kind = printable(event["kind"].replace("_", " "))
    return f"  {event['at_s']:8.2f} s  {kind}{': ' if details else ''}{details}"


def _messages(one: Explanation) -> list[list[MessageTrace]]:
    """Each message to it and from it; of a broadcast of the robot, together what each receiver got."""
    groups: dict[tuple[int, ...], list[MessageTrace]] = {}
    for place, trace in enumerate(one.traces):
        of_its_own = trace.source == one.robot and trace.broadcast
        groups.setdefault((trace.number,) if of_its_own else (-1, place), []).append(trace)
    return list(groups.values())


def _message_line(traces: list[MessageTrace], robot: int) -> str:
    first = traces[0]
    if first.source == robot and first.broadcast:
        return _broadcast(first, traces)
    return _message(first, robot)


def _broadcast(trace: MessageTrace, copies: list[MessageTrace]) -> str:
    reached = ids_in_words(copy.receiver for copy in copies if copy.delivered) or "nobody"
    missed = ", ".join(f"{copy.receiver} {copy.status}" for copy in copies if not copy.delivered)
    lost = f", LOST: {missed}" if missed else ""
    return (
        f"  {trace.offered_s:8.2f} s  to all  {trace.kind:<13} reached {reached}{lost}; {_says(trace)}"
    )


def _message(trace: MessageTrace, robot: int) -> str:
    to_it = trace.receiver == robot
    direction = f"from {trace.source}" if to_it else f"to   {trace.receiver}"
    if trace.delivered:
        delay_ms = 1e3 * (trace.arrival_s - trace.offered_s)
        outcome = f"arrived after {delay_ms:.1f} ms, SNR {trace.snr_db:.1f} dB"
    else:
        snr = f" (SNR {trace.snr_db:.1f} dB)" if trace.snr_db > LEAST_SNR_DB else ""
        outcome = f"LOST, {trace.status}{snr}: {WHY_LOST[DeliveryStatus(trace.status)]}"
    tries = f", attempts {trace.attempts}" if trace.attempts > 1 else ""
    via = f", via {ids_in_words(trace.path[1:-1])}" if len(trace.path) > 2 else ""
    became = f"{outcome}{tries}{via}; {_says(trace)}"
    return f"  {trace.offered_s:8.2f} s  {direction:<7} {trace.kind:<13} {became}"


def _says(trace: MessageTrace) -> str:
    return f"{trace.msdu_bytes} bytes" if trace.message is None else summary_of(trace.message)
