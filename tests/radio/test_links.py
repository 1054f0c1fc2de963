"""When a link is good enough to be chosen, and when it is broken."""

import pytest

from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.routing.links import REPEATED_EXCHANGES, SAMPLE_AGE_NS, SAMPLES, Links


def packet() -> DataPacket:
    return DataPacket(DataMessage(1, 1, 3, b"", 800, 0), (1,)).tried(7)


@pytest.mark.parametrize(
    ("margins_db", "worthwhile"),
    [
        ((), False),
        ((6.9,), False),
        ((7.1,), True),
        ((5.7, 5.7), False),
        ((5.9, 5.9), True),
        ((4.9, 4.9, 4.9, 4.9), False),
        ((5.1, 5.1, 5.1, 5.1), True),
        ((-20.0, 5.1, 5.1, 5.1, 5.1), True),
        ((14.0, 0.0, 0.0), False),
    ],
)
def test_a_link_is_worthwhile_a_standard_error_below_its_mean(
    margins_db: tuple[float, ...], worthwhile: bool
) -> None:
    """Mean - 4 dB / sqrt(n) >= 3 dB over the last four frames."""
    links = Links()
    for margin_db in margins_db:
        links.on_heard(2, margin_db, 0)
    assert links.is_worthwhile(2, 0) == worthwhile
    assert not links.is_worthwhile(3, 0)


def test_what_was_heard_long_ago_says_nothing() -> None:
    links = Links()
    for _ in range(SAMPLES):
        links.on_heard(2, 20.0, 0)
    assert links.is_worthwhile(2, SAMPLE_AGE_NS)
    assert not links.is_worthwhile(2, SAMPLE_AGE_NS + 1)


def test_a_link_is_broken_by_failures_in_a_row_whichever_packets_they_were() -> None:
    links = Links()
    for _ in range(REPEATED_EXCHANGES):
        assert links.on_given_up(packet(), 2) is not None
    assert links.on_given_up(packet(), 2) is None
    assert links.on_given_up(packet(), 2) is None, "until something is acknowledged"
    assert links.on_given_up(packet(), 3) is not None
    links.on_acknowledged(2)
    assert links.on_given_up(packet(), 2) is not None


def test_a_packet_that_never_gets_through_breaks_a_link_that_carries_others() -> None:
    links = Links()
    again: object = packet()
    for _ in range(REPEATED_EXCHANGES):
        assert isinstance(again, DataPacket)
        again = links.on_given_up(again, 2)
        links.on_acknowledged(2)
        again = again.tried(7) if isinstance(again, DataPacket) else again
    assert isinstance(again, DataPacket)
    assert again.attempts == (7 * (REPEATED_EXCHANGES + 1),)
    assert links.on_given_up(again, 2) is None


def test_a_broken_link_has_to_be_heard_anew() -> None:
    links = Links()
    links.on_heard(2, 20.0, 0)
    for _ in range(REPEATED_EXCHANGES + 1):
        links.on_given_up(packet(), 2)
    assert not links.is_worthwhile(2, 0)


def test_attempts_of_a_hop_add_up_and_begin_anew_elsewhere() -> None:
    once_more = packet().again()
    assert once_more.attempts == ()
    assert once_more.tried(7).attempts == (14,)
    assert once_more.tried(7).again().moved(2, 3).attempts == (17,)
    assert once_more.tried(7).again().moved(2, 3).tried(1).attempts == (17, 1)
    assert once_more.tried(7).afresh().tried(2).attempts == (2,)
