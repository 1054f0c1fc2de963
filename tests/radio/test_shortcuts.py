"""An exchange that nobody can disturb ends the same, played in three events or in eight."""

from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.airtime import dsss
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.saturation import Load, Saturation, Tally, pair

place = st.tuples(st.integers(0, 25), st.integers(0, 25))

WEAK = {"tx_power_dbm": -14.0, "receive_threshold_db": -8.0, "carrier_sense_db": -30.0}
"""23 dB at 1 m: the farther of the bystanders lock on frames that they cannot read."""


def run(load: Load, section: RadioSection, take_shortcuts: bool, seconds: float = 0.5) -> Tally:
    parts = dsss(section), link_budget(section), 7, link_rules(section)
    return Saturation(load, *parts, take_shortcuts=take_shortcuts).run(seconds)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    places=st.lists(place, min_size=2, max_size=6),
    keys=st.fixed_dictionaries(
        {
            "preamble_sinr_db": st.sampled_from([None, 0.0, 4.0]),
            "capture_db": st.sampled_from([None, 3.0]),
            "energy_detect_db": st.sampled_from([None, 38.0]),
            "rate_mbps": st.sampled_from([1.0, 11.0]),
            "cts_timeout_us": st.sampled_from([222.0, 334.0]),
            "as_ns3": st.booleans(),
        }
    ),
    rts_cts=st.booleans(),
    budget=st.sampled_from([*({"carrier_sense_db": db} for db in (10.0, 35.0, 42.0)), WEAK]),
)
def test_shortcuts_change_nothing(
    places: list[tuple[int, int]], keys: dict[str, Any], rts_cts: bool, budget: dict[str, float]
) -> None:
    section = RadioSection(shadowing_db=0.0, **keys, **budget)
    count = len(places)
    receivers = tuple(StationIndex((i + 1) % count) for i in range(count))
    load = Load(tuple((float(x), float(y)) for x, y in places), receivers, 800, rts_cts)
    assert run(load, section, True) == run(load, section, False)


def test_shortcuts_change_nothing_on_a_link_that_fades() -> None:
    section = RadioSection(short_retry_limit=7, long_retry_limit=4)
    for rts_cts in (True, False):
        load = pair(20.0, 800, rts_cts)
        tallies = [run(load, section, shortcuts, 20.0) for shortcuts in (True, False)]
        assert tallies[0] == tallies[1]
