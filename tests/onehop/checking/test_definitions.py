"""What the checker works out anew is what the programs do: two ways to one answer."""

import numpy as np
import pytest

from onehop.checking.airtime import Airtimes
from onehop.checking.payloads import Order, order_in
from onehop.checking.reach import Budget
from onehop.checking.rosters import Roster, is_newer, shape_for
from onehop.contracts.geometry import Pose
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.serial_numbers import newer
from radio_proxy.core.link_budget import CLIP, link_budget
from robot_agent.core.team import team_messages
from robot_agent.core.team.formation import median_leader, shape_of
from robot_agent.core.team.roster import Roster as TeamRoster
from robot_agent.core.team.team_messages import Beacon, Command, CommandKind, Join, MissionPhase

POSE = Pose(1.0, 2.0, 0.5)


def test_leader_and_shape_of_every_size() -> None:
    for size in range(1, 301):
        team = tuple(range(3, 3 + 2 * size, 2))
        assert Roster(0, team).leader == median_leader(team)
        for narrow in (False, True):
            assert shape_for(size, narrow) is shape_of(size, narrow)


@pytest.mark.parametrize("a", [0, 1, 2**31 - 1, 2**31, 2**31 + 1, 2**32 - 1])
@pytest.mark.parametrize("b", [0, 1, 2**31 - 1, 2**31, 2**31 + 1, 2**32 - 1])
def test_order_of_epochs(a: int, b: int) -> None:
    assert is_newer(a, b) is newer(a, b)


def test_order_of_rosters_within_an_epoch() -> None:
    rosters = [(1, 2, 3), (1, 2), (1, 3), (2, 3), (1, 2, 4), (1,), (2,)]
    for one in rosters:
        for other in rosters:
            beats = TeamRoster(1, one).beats(TeamRoster(1, other))
            assert Roster(1, one).is_larger(Roster(1, other)) is beats


@pytest.mark.parametrize("preset", ["thesis", "physical", "indoor"])
def test_mean_snr_over_distance(preset: str) -> None:
    section = RadioSection(preset=preset, antenna_gain_dbi=2.0, reference_distance=2.0)  # type: ignore[arg-type]
    distances = np.array([0.5, 2.0, 8.0, 25.0, 300.0])
    expected = [link_budget(section).mean_snr_db(distance) for distance in distances.tolist()]
    assert Budget(section).mean_snr_db(distances) == pytest.approx(expected, abs=0.01)
    programs, checkers = link_budget(section), Budget(section)
    assert checkers.threshold_db == programs.receive_threshold_db
    assert checkers.shadowing_db == programs.shadowing_db
    assert checkers.worst_place_db == CLIP * programs.spatial_shadowing_db


def test_what_places_and_paths_add_at_most() -> None:
    places = Budget(RadioSection(spatial_shadowing_db=5.0))
    assert (places.worst_place_db, places.best_db) == (15.0, 15.0)
    both = Budget(RadioSection(spatial_shadowing_db=5.0, fast_fading="rayleigh"))
    assert (both.worst_place_db, both.best_db) == (15.0, 27.0)


@pytest.mark.parametrize(
    ("rate", "rts_us", "basic_us"),
    [(1.0, 7540.0, 6864.0), (11.0, 1474.545, 798.545)],
)
def test_least_airtime_of_a_message_of_800_bytes(rate: float, rts_us: float, basic_us: float) -> None:
    """RTS 352, CTS 304, two SIFS of 10, and 192 + 8 (34 + 800) / R us (thesis 3.7)."""
    clear = Airtimes(RadioSection(rate_mbps=rate))
    basic = Airtimes(RadioSection(rate_mbps=rate, rts_threshold_bytes=2304))
    assert clear.message_ns(800, False, 1) / 1e3 == pytest.approx(rts_us, abs=0.01)
    assert basic.message_ns(800, False, 2) / 2e3 == pytest.approx(basic_us, abs=0.01)
    assert clear.message_ns(800, True, 1) / 1e3 == pytest.approx(6864.0)


def test_commands_and_beacons_are_read_and_the_rest_is_left_alone() -> None:
    roster, phase = TeamRoster(7, (1, 2, 5)), MissionPhase.DRIVING
    command = Command(CommandKind.NARROW, roster, 3, phase, True, POSE, (4,), ((1.0, 2.0),))
    beacon = Beacon(roster, phase, False, POSE)
    payload = team_messages.encode(command)
    mine = Roster(7, (1, 2, 5))
    assert order_in(payload) == Order("narrow", mine, True)
    assert order_in(team_messages.encode(beacon)) == Order("beacon", mine, False)
    assert order_in(team_messages.encode(Join(1, POSE))) is None
    for garbage in (b"", b"x", payload[:-1], payload[:20] + b"!" + payload[21:]):
        assert order_in(garbage) is None
