"""Maps of random and damaged bytes: MapError or a map, never another exception, soon and small."""

import time
import tracemalloc
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.errors import MapError
from onehop.contracts.sections import MapSection
from onehop.maps.map_file import load_map, map_files
from tests.onehop.maps.pictures import PGM, YAML, encoded, png

GRID = b"type octile\nheight 2\nwidth 3\nmap\n.G@\nSTW\n"
MOST_MEMORY = 64 << 20
"""What a map of some hundred bytes may take for a moment [bytes]."""
MOST_TIME = 2.0
"""Processor time for it; a few milliseconds are usual [s]."""

PICTURES = (
    PGM,
    b"P2 3 2 255 # x\n254 0 205\n254 254 254\n",
    b"P5 2 1 1000\n\0\1\2\3",
    png([[(254,), (0,)], [(205,), (254,)]], 0),
    png([[(254, 254, 254, 255), (0, 9, 0, 3)]], 6),
    encoded([[0, 1, 2]], "L", "PNG", transparency=1),
    encoded([[254, 0, 205]] * 3, "L", "BMP"),
    encoded([[(254, 254, 254), (1, 2, 3)]], "RGB", "BMP"),
)


def damaged(*whole: bytes) -> st.SearchStrategy[bytes]:
    """One of these with some bytes changed, cut out, doubled, or something of another one put in."""
    pieces = st.one_of(
        st.binary(max_size=8),
        st.sampled_from(
            [b"\0", b"\xff" * 4, b"\t", b"\n", b"#", b"999999999999", b"-1", b"nan", b"[", b"*a"]
        ),
        st.sampled_from(whole),
    )
    change = st.tuples(st.integers(0, 400), st.integers(0, 12), pieces)

    def changed(content: bytes, changes: list[tuple[int, int, bytes]]) -> bytes:
        for place, length, piece in changes:
            at = place % (len(content) + 1)
            content = content[:at] + piece + content[at + length :]
        return content

    return st.builds(changed, st.sampled_from(whole), st.lists(change, min_size=1, max_size=4))


def bounded(read: Callable[[], object]) -> None:
    """Read twice: for the time, and for the memory, whose tracing takes 100 times as long."""
    began = time.process_time()
    refusal = refused(read)
    took = time.process_time() - began
    assert not refusal or (refusal.isprintable() and len(refusal) < 400)
    assert took < MOST_TIME
    tracemalloc.start()
    try:
        refused(read)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < MOST_MEMORY


def refused(read: Callable[[], object]) -> str:
    try:
        read()
    except MapError as error:
        return str(error)
    return ""


def ros(yaml: bytes, image: bytes) -> None:
    names = map_files("m.yaml", yaml)
    load_map(MapSection(file="m.yaml"), {"m.yaml": yaml, names[0]: image})


@settings(max_examples=150, deadline=None)
@given(
    st.one_of(
        st.binary(max_size=300), damaged(YAML.encode(), b"a: &a [*a]\n", b"? {x: 1}\n: - |\n  t\n")
    )
)
def test_any_bytes_as_yaml_end_in_a_map_or_a_map_error(yaml: bytes) -> None:
    bounded(lambda: ros(yaml, PGM))


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=200))
def test_any_text_as_yaml_ends_in_a_map_or_a_map_error(yaml: str) -> None:
    bounded(lambda: ros(yaml.encode("utf-8", "surrogatepass"), PGM))


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
@settings(max_examples=150, deadline=None)
@given(
    image=st.one_of(
        st.builds(
            bytes.__add__, st.sampled_from([b"P2 ", b"P5 ", b"BM", b"\x89PNG\r\n\x1a\n"]), st.binary()
        ),
        damaged(*PICTURES),
    )
)
def test_any_bytes_as_a_picture_end_in_a_map_or_a_map_error(mode: str, image: bytes) -> None:
    bounded(lambda: ros(YAML.encode() + f"mode: {mode}\n".encode(), image))


@settings(max_examples=150, deadline=None)
@given(st.one_of(st.binary(max_size=300), damaged(GRID)))
def test_any_bytes_as_a_movingai_grid_end_in_a_map_or_a_map_error(grid: bytes) -> None:
    bounded(lambda: load_map(MapSection(file="m.map"), {"m.map": grid}))


def test_a_log_that_lacks_a_file_of_its_map_is_refused() -> None:
    with pytest.raises(MapError, match=r"m\.pgm: missing"):
        load_map(MapSection(file="m.yaml"), {"m.yaml": YAML.encode()})
    with pytest.raises(MapError, match=r"m\.yaml: missing"):
        load_map(MapSection(file="m.yaml"), {})
