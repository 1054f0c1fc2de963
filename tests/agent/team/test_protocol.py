"""Election and recovery on a quiet network: the scenarios of the thesis, and those beyond it."""

import copy
import itertools

import pytest

from onehop.contracts.geometry import Pose
from onehop.contracts.sections import TeamSection
from onehop.contracts.team import Mode, Shape
from robot_agent.core.team.join_probation import JoinProbation
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import Beacon, Command, CommandKind, Join, MissionPhase, encode
from tests.agent.team.team_net import TeamNet, drive, thesis

NEXT_PERIOD = 2.0
BOUND = 4 * NEXT_PERIOD


def test_setup_ends_when_all_are_in_position_and_the_leader_waits_for_it():
    net = TeamNet(TeamSection())
    while net.status(3).mode is Mode.SETUP if net.tick else True:
        x = net.members[3].pose.x
        net.step()
        assert net.members[3].pose.x == x, "the leader stands still until the team is formed"
        assert net.seconds < 40.0
    assert all(net.status(i).error < 0.5 for i in (1, 2, 4, 5, 6))
    net.run(5.0)
    assert net.members[3].pose.x > x
    assert [net.status(i).mode for i in sorted(net.members)].count(Mode.FOLLOWING) == 5


def test_setup_timeout_in_profile_thesis_loses_who_is_not_in_position():
    net = TeamNet(thesis(setup_timeout=25.0))
    stuck = net.members[5].pose
    while net.seconds < 35.0:
        net.members[5].pose = stuck
        net.step()
    assert net.status(3).members == (1, 2, 3, 4, 6)
    assert net.status(3).shape is Shape.WEDGE
    assert losses(net) == [(3, (5,), "not in position at setup")]


def losses(net):
    return [
        (robot, note.data["robots"], note.data["reason"])
        for _, robot, note in net.notes
        if note.kind == "lost_follower"
    ]


def test_silence_and_a_missed_slot_at_the_end_of_setup_are_two_notes_with_their_reasons():
    """Robot 6 falls silent in its slot so that its third missed period ends with the setup."""
    net = TeamNet(thesis(setup_timeout=25.0))
    stuck = net.members[5].pose
    while net.seconds < 35.0:
        net.members[5].pose = stuck
        if net.seconds >= 21.0 and 6 in net.members:
            net.kill(6)
        net.step()
    assert losses(net) == [(3, (6,), "unanswered"), (3, (5,), "not in position at setup")]
    first, second = (seconds for seconds, _, note in net.notes if note.kind == "lost_follower")
    assert first == second
    assert net.status(3).members == (1, 2, 3, 4)


@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_followers_6_and_1_lost_give_a_diamond(profile):
    """Thesis figure 4.21."""
    net = drive(TeamSection() if profile == "team" else thesis())
    net.kill(6)
    net.kill(1)
    net.run(10.0)
    assert net.leaders() == (3,)
    assert net.status(3).members == (2, 3, 4, 5)
    assert {net.status(i).shape for i in net.members} == {Shape.DIAMOND}


@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_leader_3_stopped_makes_4_lead_a_wedge(profile):
    """Thesis figure 4.22."""
    net = drive(TeamSection() if profile == "team" else thesis())
    net.kill(3)
    net.run(net.scenario.team.leader_timeout + 2 * NEXT_PERIOD)
    assert net.leaders() == (4,)
    assert net.agree()
    assert {net.status(i).shape for i in net.members} == {Shape.WEDGE}


def test_figure_3_4_a_leader_3_fails_among_1_2_4_5():
    net = drive(thesis(ids=(1, 2, 3, 4, 5)))
    net.kill(3)
    net.run(12.0)
    assert net.leaders() == (2,)
    assert net.agree()
    assert {net.status(i).shape for i in net.members} == {Shape.DIAMOND}


@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_figure_3_4_b_loss_of_follower_4_makes_2_lead_although_3_lives(profile):
    net = drive(TeamSection(profile=profile, ids=(1, 2, 3, 4, 5)))
    net.kill(4)
    net.run(10.0)
    assert net.leaders() == (2,)
    assert net.agree()
    assert net.status(3).mode is Mode.FOLLOWING
    assert {net.status(i).shape for i in net.members} == {Shape.DIAMOND}


@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_leaders_fail_one_after_the_other_down_to_two(profile):
    net = drive(TeamSection(profile=profile))
    team = net.scenario.team
    while len(net.members) > 2:
        (leader,) = net.leaders()
        net.kill(leader)
        net.run(team.leader_timeout + 2 * NEXT_PERIOD)
        assert len(net.leaders()) == 1
        assert net.agree()
    assert {net.status(i).shape for i in net.members} == {Shape.COLUMN}


@pytest.mark.parametrize(("orphan", "mode"), [("stop", Mode.STOPPED), ("solo", Mode.ALONE)])
def test_an_orphan_of_profile_thesis_stops_or_goes_alone(orphan, mode):
    """Thesis 3.8.1."""
    net = drive(thesis(orphan=orphan))
    net.cut((1,))
    net.run(5 * net.scenario.team.leader_timeout + 2 * NEXT_PERIOD)
    assert net.status(1).mode is mode


@pytest.mark.parametrize("profile", ["team", "thesis"])
@pytest.mark.parametrize("dead", [(3, 4), (3, 4, 2), (3, 2, 5)])
def test_leaders_that_die_at_once_are_given_up_one_after_the_other(profile, dead):
    """Thesis 3.3.5: leaders may fail more than once; the elected one may be dead as well."""
    net = drive(TeamSection() if profile == "team" else thesis())
    for robot in dead:
        net.kill(robot)
    net.run(len(dead) * (net.scenario.team.leader_timeout + 2 * NEXT_PERIOD) + BOUND)
    assert net.agree(), net.describe()
    assert len(net.leaders()) == 1


def test_a_leader_that_was_cut_off_goes_on_alone():
    """Thesis 4.3."""
    net = drive(thesis())
    net.cut((3,))
    net.run(12.0)
    assert net.status(3).mode is Mode.ALONE
    x = net.members[3].pose.x
    net.run(4.0)
    assert net.members[3].pose.x > x + 2.0
    assert net.status(4).leader == 4


def last_disagreement(net, seconds):
    """When the present robots last disagreed about their roster [s], from now on."""
    began, last = net.seconds, 0.0
    while net.seconds < began + seconds:
        net.step()
        if len(net.leaders()) != 1 or not net.agree():
            last = net.seconds - began
    return last


def test_deaths_at_the_moment_of_healing_take_more_than_four_periods_and_at_most_seven():
    """docs/modes.md: 4 has to give 5 up first, and the union that it forms then still names 6."""
    took = []
    for phase in range(8):
        net = drive()
        net.cut((1, 2, 3))
        net.run(14.0 + 0.25 * phase)
        net.heal()
        net.kill(5)
        net.kill(6)
        took.append(last_disagreement(net, 30.0))
        assert net.status(1).members == (1, 2, 3, 4)
    assert BOUND < max(took) <= BOUND + 3 * NEXT_PERIOD


def test_a_cut_makes_two_teams_and_healing_one_again_within_four_periods():
    net = drive()
    net.cut((1, 2, 3))
    net.run(20.0)
    assert [net.status(i).members for i in (1, 2, 3)] == [(1, 2, 3)] * 3
    assert [net.status(i).members for i in (4, 5, 6)] == [(4, 5, 6)] * 3
    assert net.leaders() == (2, 5)
    net.heal()
    net.run(BOUND)
    assert net.agree()
    assert net.leaders() == (3,)


def test_a_killed_robot_that_restarts_joins_again():
    net = drive()
    net.kill(5)
    net.run(10.0)
    net.restart(5)
    net.run(BOUND)
    assert net.agree()
    assert net.status(5).members == (1, 2, 3, 4, 5, 6)


def test_a_robot_that_comes_and_goes_is_taken_in_later_each_time():
    net = drive()
    waits = []
    for _ in range(3):
        net.cut((6,))
        net.run(10.0)
        net.heal()
        start = net.seconds
        while not net.agree():
            net.step()
            assert net.seconds - start <= BOUND
        waits.append(net.seconds - start)
    assert min(waits[1:]) > waits[0]


def test_commands_out_of_turn_do_not_count_as_unanswered():
    """Found by the state machine: a robot joins, the leader speaks at once, and a tick later it is time
    for the ordinary Next: who just heard the first one was given up."""
    net = TeamNet(TeamSection())
    net.cut((1,))
    net.paused[5] = 10
    net.run(4.5)
    net.heal()
    net.paused.clear()
    net.run(BOUND)
    assert net.agree(), net.describe()
    assert not [note for seconds, _, note in net.notes if note.kind == "lost_follower" and seconds > 4.5]


def test_probation_grows_with_every_loss_up_to_three_periods_in_a_row():
    known = JoinProbation()
    assert known.meet(6, period=10)
    known.give_up((6,))
    assert [known.meet(6, period) for period in (20, 20, 21)] == [False, False, True]
    known.give_up((6,))
    known.give_up((6,))
    assert [known.meet(6, period) for period in (30, 31, 33, 34, 35)] == [False] * 4 + [True]


def test_two_leaders_that_hear_each_other_form_the_same_union():
    a, b = Roster(4, (2, 3, 5)), Roster(7, (1, 3, 6))
    assert a.merged(b.epoch, b.members) == b.merged(a.epoch, a.members) == Roster(8, (1, 2, 3, 5, 6))


def test_stale_epoch_is_ignored():
    net = drive()
    net.kill(3)
    net.run(12.0)
    before = net.status(1)
    stale = Command(
        CommandKind.NEXT,
        Roster(0, (1, 2, 3, 4, 5, 6)),
        99,
        MissionPhase.FINAL,
        True,
        Pose(0.0, 0.0, 0.0),
        (),
        (),
    )
    net.inject(3, 1, encode(stale))
    net.run(0.5)
    after = net.status(1)
    assert (after.epoch, after.leader, after.mode) == (before.epoch, before.leader, before.mode)


def test_foreign_and_hostile_payloads_are_counted_and_ignored():
    net = drive()
    here = Pose(0.0, 0.0, 0.0)
    strangers, usurped = Roster(900, (1, 2, 3, 4, 9)), Roster(900, (1, 2, 3))
    hostile = [
        (7, encode(Join(5, here))),  # nobody's robot
        (3, b"\xc1\xff"),  # no msgpack at all
        (
            3,
            encode(Beacon(Roster(900, (3, 9, 12)), MissionPhase.DRIVING, False, here)),
        ),  # strangers listed
        (3, encode(Command(CommandKind.NEXT, strangers, 1, MissionPhase.FINAL, False, here, (), ()))),
        (5, encode(Beacon(Roster(900, (1, 2, 3)), MissionPhase.DRIVING, False, here))),  # not its leader
        (5, encode(Command(CommandKind.NEXT, usurped, 0, MissionPhase.FINAL, False, here, (), ()))),
        (1, encode(Join(2**31 - 1, here))),  # to a follower: not its business
    ]
    before = {i: net.status(i) for i in (1, 2)}
    for source, payload in hostile:
        net.inject(source, 1, payload)
        net.inject(source, 2, payload)
    net.run(0.5)
    for i in (1, 2):
        after = net.status(i)
        assert (after.epoch, after.members, after.mode) == (0, before[i].members, before[i].mode)
        counters = net.members[i].robot.ignored
        assert counters["garbled"] == 1
        assert ("garbled", {"robots": (3,)}) in [(n.kind, n.data) for _, r, n in net.notes if r == i]
        assert counters["foreign"] >= 3


def test_a_missing_next_counts_as_throughput_zero_and_the_follower_hurries():
    net = drive()
    assert net.status(1).throughput_bps == pytest.approx(8 * 800 / 8.214e-3, rel=1e-6)
    assert net.status(1).k_rho == 1.0
    net.losing.add((3, 1))
    net.run(3.0)
    assert net.status(1).throughput_bps == 0.0
    assert net.status(1).k_rho == 3.0


def gains_of(net, robot, seconds):
    """k_rho of a robot at each tick in which it follows [1/s], from now on."""
    gains = []
    for _ in range(round(seconds * 4)):
        net.step()
        if robot not in net.leaders():
            gains.append(net.status(robot).k_rho)
    return gains


@pytest.mark.parametrize("robot", [2, 5])
def test_a_robot_that_led_for_long_begins_to_follow_without_hurry(robot):
    """It was owed no Next while it led; as many as fit into that time were counted as missed."""
    net = drive()
    net.cut((1, 2, 3))
    net.run(80.0)
    assert robot in net.leaders()
    net.heal()
    gains = gains_of(net, robot, 2 * BOUND)
    assert len(gains) > 40
    assert set(gains) == {1.0}


def test_a_restarted_robot_begins_with_the_gain_of_a_first_one():
    net = drive()
    net.kill(5)
    net.run(60.0)
    net.restart(5)
    gains = gains_of(net, 5, 2 * BOUND)
    assert net.agree()
    assert set(gains) == {1.0}


def test_at_the_goal_everyone_stops_in_its_slot():
    net = TeamNet(TeamSection(), goal=(40.0, 10.0))
    net.run(75.0)
    assert {net.status(i).mode for i in net.members} == {Mode.STOPPED}
    assert all(net.status(i).error < 0.5 for i in net.members)


def test_a_leader_lost_at_the_goal_is_replaced():
    net = TeamNet(TeamSection(), goal=(40.0, 10.0))
    net.run(75.0)
    net.kill(3)
    net.run(40.0)
    assert net.leaders() == (4,)
    assert {net.status(i).mode for i in net.members} == {Mode.STOPPED}


@pytest.mark.parametrize("size", [1, 2, 3, 24, 50])
def test_teams_of_any_size_form_and_drive(size):
    net = TeamNet(TeamSection(size=size))
    net.run(50.0)
    assert net.agree()
    (leader,) = net.leaders()
    assert net.status(leader).mode is (Mode.ALONE if size == 1 else Mode.LEADING)


@pytest.mark.parametrize(
    ("size", "stride"),
    [
        (3, 1),
        pytest.param(4, 13, marks=pytest.mark.slow),
        pytest.param(4, 1, marks=[pytest.mark.slow, pytest.mark.campaign]),
    ],
)
def test_every_order_of_loss_in_the_first_rounds_of_an_election_ends_with_one_leader(size, stride):
    """The leader dies; each frame among the rest is lost or not, in every combination, for four ticks
    after the election begins; then the network is quiet for the bound. stride: each so many-th order."""
    rest = [i for i in range(1, size + 1) if i != (size + 1) // 2]
    links = [(a, b) for a in rest for b in rest if a != b]
    rounds = 3 if size == 3 else 2
    leaderless = TeamNet(TeamSection(size=size))
    leaderless.run(12.0)
    leaderless.kill((size + 1) // 2)
    leaderless.run(4.0)
    orders = itertools.product((False, True), repeat=rounds * len(links))
    for losses in itertools.islice(orders, 0, None, stride):
        net = copy.deepcopy(leaderless)
        for number in range(rounds):
            chosen = losses[number * len(links) : (number + 1) * len(links)]
            net.losing = {link for link, lost in zip(links, chosen, strict=True) if lost}
            net.run(1.0)
            net.check()
        net.heal()
        net.run(BOUND)
        net.check()
        assert len(net.leaders()) == 1, losses
        assert net.agree(), losses
