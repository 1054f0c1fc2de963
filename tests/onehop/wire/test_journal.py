"""Whatever order messages arrive in, the journal writes one order."""

from hypothesis import given
from hypothesis import strategies as st

from onehop.wire.batch import pack_tick, unpack_tick
from onehop.wire.journal import Journal, WireMessage

TICK: list[WireMessage] = [
    ("truth", b"t"),
    ("radio", b"e"),
    ("rx/2", b"r"),
    ("rx/10", b"r"),
    ("obs/2", b"o"),
    ("obs/10", b"o"),
    ("out/2", b"a"),
    ("late", b"l"),
    ("base/2", b"m"),
    ("base/10", b"m"),
]


def _nowhere(_tick: int, _messages: list[WireMessage]) -> None:
    """Where ticks go that nobody wants."""


@given(st.permutations(TICK))
def test_the_digest_does_not_depend_on_the_order_of_arrival(messages: list[WireMessage]) -> None:
    written: list[tuple[int, list[WireMessage]]] = []
    journal = Journal(lambda tick, ordered: written.append((tick, ordered)))
    reference = Journal(_nowhere)
    journal.add(0, messages)
    reference.add(0, TICK)
    assert journal.digest() == reference.digest()
    assert written == [(0, TICK)]
    assert journal.last_tick == 0


def test_the_digest_depends_on_every_byte_key_and_tick() -> None:
    def digest(tick: int, key: str, data: bytes) -> str:
        journal = Journal(_nowhere)
        journal.add(tick, [(key, data)])
        return journal.digest()

    digests = {
        digest(0, "obs/1", b"a"),
        digest(1, "obs/1", b"a"),
        digest(0, "obs/2", b"a"),
        digest(0, "obs/1", b"b"),
        digest(0, "obs/1", b"ab"),
    }
    assert len(digests) == 5


messages_of_a_tick = st.lists(st.tuples(st.text(max_size=9), st.binary(max_size=30)), max_size=5)


@given(st.integers(0, 2**40), messages_of_a_tick)
def test_a_record_keeps_messages_byte_for_byte(tick: int, messages: list[WireMessage]) -> None:
    assert unpack_tick(pack_tick(tick, messages)) == (tick, messages)
