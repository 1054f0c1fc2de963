"""The invariants by name, and what each of them says in one sentence."""

COMPLETE = "complete"
DIGEST = "digest"
OWN_VOICE = "own-voice"
SILENCE = "silence"
MEDIAN = "median"
SHAPE = "shape"
EPOCHS = "epochs"
ONE_LEADER = "one-leader"
ONE_TEAM = "one-team"
RE_ELECTION = "re-election"
RADIO_INTEGRITY = "radio-integrity"
FAULT_BIT = "fault-bit"
NO_COLLISION = "no-collision"
MOTION = "motion"

INVARIANTS: dict[str, str] = {
    COMPLETE: "every tick has truth, radio record, and all messages of each robot that runs, once",
    DIGEST: "the messages of a finished log are those that its mission had, by number and digest",
    OWN_VOICE: "every message lies under the key of who said it, and the world passes on what was said",
    SILENCE: "a robot that has left the mission, or is stopped, says nothing and is told nothing",
    MEDIAN: "the leader of every roster is the median of its members",
    SHAPE: "every shape is the one that the size of the team, or Narrow, asks for",
    EPOCHS: "no epoch of a robot goes back, and no older roster is obeyed",
    ONE_LEADER: "robots that hear each other, unbroken, have one leader in the end",
    ONE_TEAM: "robots that hear each other, unbroken, and nobody else, are one team in the end",
    RE_ELECTION: "after a leader has left, a new one acts in time",
    RADIO_INTEGRITY: "nothing is delivered that was not sent, or twice, altered, or before its airtime",
    FAULT_BIT: "every fault begins when it is due and shows its effect as long as it lasts",
    NO_COLLISION: "no robot touches an obstacle or another robot",
    MOTION: "no robot moves farther than its command and its motors allow",
}
"""In the order in which they are told."""

COUNTED: dict[str, str] = {
    COMPLETE: "ticks",
    DIGEST: "logs",
    OWN_VOICE: "ticks of robots",
    SILENCE: "ticks of absent robots",
    MEDIAN: "rosters",
    SHAPE: "shapes",
    EPOCHS: "ticks of robots",
    ONE_LEADER: "ticks",
    ONE_TEAM: "ticks of teams",
    RE_ELECTION: "elections",
    RADIO_INTEGRITY: "verdicts",
    FAULT_BIT: "faults",
    NO_COLLISION: "ticks of robots",
    MOTION: "ticks of robots",
}
"""What is counted of each, in the plural."""

UNEXERCISED: dict[str, str] = {
    DIGEST: "the log has no outcome to be held against",
    SILENCE: "no robot left the mission or was stopped",
    ONE_LEADER: "no two robots heard each other, unbroken, for the bound",
    ONE_TEAM: "no robots heard each other, unbroken, and nobody else, for the bound",
    RE_ELECTION: "no leader left robots behind that heard each other until the bound was over",
    RADIO_INTEGRITY: "no message was sent",
    FAULT_BIT: "there was no fault",
}
"""Why there was nothing to judge; the others are exercised by every log that has a tick."""

NOT_IN_THESIS: dict[str, str] = {
    ONE_TEAM: "profile thesis has no rule by which two teams become one",
    ONE_LEADER: "profile thesis has no rule by which two leaders become one",
}
"""What profile `thesis` does not promise."""

WITHOUT_TEAM: dict[str, str] = dict.fromkeys(
    (MEDIAN, SHAPE, EPOCHS, ONE_LEADER, ONE_TEAM, RE_ELECTION),
    "no robot said anything of a team: its program has none",
)
"""Why nothing was asked of a team in a mission of other programs."""

WITH_ANOTHER_PROPAGATION: dict[str, str] = dict.fromkeys(
    (ONE_LEADER, ONE_TEAM, RE_ELECTION),
    "who hears whom is a plugin's word (radio.propagation), and not worked out anew",
)
"""What is not asked where the checker cannot tell links."""

IN_REAL_TIME: dict[str, str] = dict.fromkeys(
    (ONE_LEADER, ONE_TEAM, RE_ELECTION),
    "in real time a robot may miss ticks, and the bound counts on all of them",
)
"""What is not asked where nobody waits for a robot."""
