"""What is in a log and where: stretches found by their log times."""

from hypothesis import given
from hypothesis import strategies as st

from onehop.wire.contents import Contents, Stretch

times = st.integers(0, 20)
stretch = st.tuples(times, times).map(lambda ends: Stretch(0, 1, min(ends), max(ends), is_chunk=True))
in_order = st.lists(times, max_size=20).map(
    lambda ends: [
        Stretch(0, 1, first, last, is_chunk=True)
        for first, last in zip(sorted(ends), sorted(ends)[1:], strict=False)
    ]
)


@given(st.lists(stretch, max_size=12) | in_order, st.integers(0, 12), times, times)
def test_stretches_of_a_time_are_those_that_a_look_at_all_finds(
    heads: list[Stretch], known: int, first: int, last: int
) -> None:
    """In order or not, and also those that have been added since the last look."""
    contents = Contents(stretches=heads[:known])
    for _ in range(2):
        wanted = [one for one in contents.stretches if one.last_ns >= first and one.first_ns <= last]
        assert list(contents.stretches_of(first, last)) == wanted
        contents.stretches += heads[known:]
        known = len(heads)
