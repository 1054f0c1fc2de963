"""Whatever order world and radio report in, the journal writes one order."""

from hypothesis import given
from hypothesis import strategies as st

from onehop.drive.journal import Journal, WireMessage
from onehop.drive.record import pack_record, unpack_record


def _nowhere(_tick: int, _messages: list[WireMessage]) -> None:
    """Where ticks go that nobody wants."""


def _halves(ticks: int) -> list[tuple[int, list[WireMessage]]]:
    halves: list[tuple[int, list[WireMessage]]] = []
    for tick in range(ticks):
        stamp = str(tick).encode()
        halves.append((tick, [("truth", stamp), ("obs/10", stamp), ("obs/2", stamp), ("out/2", stamp)]))
        halves.append((tick, [("rx/10", stamp), ("ether", stamp), ("rx/2", stamp)]))
    return halves


@given(st.permutations(_halves(4)))
def test_the_digest_does_not_depend_on_who_reports_first(
    halves: list[tuple[int, list[WireMessage]]],
) -> None:
    by_tick = sorted(halves, key=lambda half: half[0])  # ticks in order, the two sides of each in any
    written: list[tuple[int, list[WireMessage]]] = []
    journal = Journal(lambda tick, messages: written.append((tick, messages)))
    reference = Journal(_nowhere)
    for tick, messages in by_tick:
        journal.add(tick, list(messages))
    for tick, messages in _halves(4):
        reference.add(tick, list(messages))
    assert journal.digest() == reference.digest()
    assert [tick for tick, _ in written] == [0, 1, 2, 3]
    expected = ["truth", "ether", "rx/2", "rx/10", "obs/2", "obs/10", "out/2"]
    assert [key for key, _ in written[0][1]] == expected


def test_the_digest_depends_on_every_byte_key_and_tick() -> None:
    def digest(tick: int, key: str, data: bytes) -> str:
        journal = Journal(_nowhere)
        journal.add(tick, [(key, data)])
        journal.add(tick, [])
        return journal.digest()

    digests = {
        digest(0, "obs/1", b"a"),
        digest(1, "obs/1", b"a"),
        digest(0, "obs/2", b"a"),
        digest(0, "obs/1", b"b"),
        digest(0, "obs/1", b"ab"),
    }
    assert len(digests) == 5


def test_a_half_without_its_other_side_is_kept_for_the_end() -> None:
    journal = Journal(_nowhere)
    journal.add(5, [("truth", b"x")])
    assert journal.complete == -1
    assert journal.rest() == [(5, [("truth", b"x")])]


@given(
    st.integers(0, 2**40), st.lists(st.tuples(st.text(max_size=9), st.binary(max_size=30)), max_size=5)
)
def test_a_record_keeps_messages_byte_for_byte(tick: int, messages: list[WireMessage]) -> None:
    assert unpack_record(pack_record(tick, messages)) == (tick, messages)
