"""What a robot has heard in real time, as one inbox."""

from onehop.contracts.messages import Heard, Reception
from onehop.contracts.neighbour import Neighbour
from onehop.wire.heard import inbox_of


def reception(source: int) -> Reception:
    return Reception(source, b"hi", 0, 1000 * source, 1, 1, 20.0, 0.0, 100)


def test_receptions_stay_in_order_and_every_number_is_named() -> None:
    inbox = inbox_of(7, 350, [Heard(4, reception(2)), Heard(5), Heard(6, reception(1))])
    assert (inbox.tick, inbox.time_ns, inbox.heard) == (7, 350, (4, 5, 6))
    assert [one.source for one in inbox.receptions] == [2, 1]


def test_the_last_report_of_a_neighbour_counts_with_the_frames_of_all() -> None:
    first = Heard(1, neighbours=(Neighbour(3, 10.0, -80.0, 100, 2), Neighbour(5, 9.0, -81.0, 90, 1)))
    second = Heard(2, neighbours=(Neighbour(3, 12.0, -78.0, 200, 4),))
    inbox = inbox_of(0, 0, [first, second])
    assert inbox.neighbours == (Neighbour(3, 12.0, -78.0, 200, 6), Neighbour(5, 9.0, -81.0, 90, 1))
