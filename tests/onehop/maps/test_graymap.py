"""Portable graymaps: what Netpbm defines, what other programs write, and what is refused."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.errors import MapError
from onehop.maps.graymap import read_graymap


def grey(content: bytes) -> list[list[int]]:
    pixels: list[list[int]] = read_graymap("m.pgm", content).tolist()
    return pixels


@pytest.mark.parametrize(
    "content",
    [
        b"P5 3 1 255\n\x0a\x23\x20",
        b"P5\n# one\n3 # two\n#three\n 1\n255\n\x0a\x23\x20",
        b"P5\r\n3 1\r\n255\r\n\x0a\x23\x20",
        b"P5\n3 1\n255\r\n\x0a\x23\x20",
        b"P5\n3 1\n255\r\x0a\x23\x20",
        b"P5\n3 1\n255#late\n\x0a\x23\x20",
        b"P5\n3 1\n255\n# late\n\x0a\x23\x20",
        b"P5\r\n3 1\r\n255 # late\r\n\x0a\x23\x20",
        b"P5 3 1 255\n\x0a\x23\x20and what follows",
        b"P2 3 1 255 10 35 32",
        b"P2\r\n3 1\r\n255\r\n10\r\n35\t0000000000032\r\n",
        b"P2 3 1 255 # a\n10 #35 36\n35\n32#",
        b"P2 3 1 255 10 35 32 99 98",
    ],
    ids=["P5", "comments", "CRLF", "CRLF at the end", "CR at the end", "comment at once", "late comment",
         "late comment with CRLF", "more bytes", "P2", "P2 with CRLF", "P2 with comments",
         "P2 with more numbers"],
)  # fmt: skip
def test_a_graymap_is_read_whatever_its_line_ends_and_comments(content: bytes) -> None:
    """Pixels that look like a line feed, a comment and a space stay what they are."""
    assert grey(content) == [[10, 35, 32]]


def test_a_raw_picture_that_begins_with_a_comment_sign_is_none() -> None:
    assert grey(b"P5 2 2 255\n#\n\n\n") == [[35, 10], [10, 10]]


@pytest.mark.parametrize("largest", [1, 15, 100, 254, 255, 256, 1000, 65535])
def test_a_grey_is_a_share_of_the_largest_rounded_down(largest: int) -> None:
    """As GraphicsMagick: 50 of 100 is 127."""
    values = list(range(0, largest + 1, max(1, largest // 200)))
    expected = [[value * 255 // largest for value in values]]
    size = f"{len(values)} 1 {largest}\n"
    kind = "B" if largest < 256 else "H"
    assert grey(f"P5 {size}".encode() + struct.pack(f">{len(values)}{kind}", *values)) == expected
    assert grey(f"P2 {size}{' '.join(map(str, values))}".encode()) == expected


GREYS, SPACES = st.lists(st.integers(0, 255), min_size=1, max_size=40), [b"\n", b"\r\n", b" ", b"\t"]


@given(values=GREYS, space=st.sampled_from(SPACES))
def test_raw_and_plain_say_the_same(values: list[int], space: bytes) -> None:
    header = space.join([str(len(values)).encode(), b"1", b"255"])
    plain = space.join([b"P2", header, *(str(value).encode() for value in values)])
    raw = b"P5" + space + header + space + bytes(values)
    assert grey(plain) == grey(raw) == [values]


def test_a_long_plain_picture_is_read_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("onehop.maps.graymap._PIECE", 100)
    values = np.random.default_rng(5).integers(0, 1000, (50, 40))
    text = " ".join(map(str, values.reshape(-1).tolist()))
    np.testing.assert_array_equal(
        read_graymap("m.pgm", f"P2 40 50 999 {text}".encode()), values * 255 // 999
    )


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"P5", "broken PGM header"),
        (b"P5\n3 x\n", "broken PGM header"),
        (b"P5 3 1 255", "broken PGM header"),
        (b"P52 1 255\n12", "broken PGM header"),
        (b"P5 2 1 255x12", "broken PGM header"),
        (b"P5 #" + b"x" * 70000 + b"\n1 1 255\n1", "broken PGM header"),
        (b"P5 2 -1 255\n12", "broken PGM header"),
        (b"P5 3 2 0\n", "3 x 2 pixels up to 0"),
        (b"P5 3 2 65536\n", "3 x 2 pixels up to 65536"),
        (b"P5 0 2 255\n", "0 x 2 pixels"),
        (b"P5 99999 99999 255\n", "99999 x 99999 pixels; at least one, and at most 67108864"),
        (b"P5 " + b"9" * 5000 + b" 1 255\n1", "a number of 5000 digits"),
        (b"P5 3 1 255\n12", "2 pixels; 3 x 1 = 3"),
        (b"P5\r\n3 1\r\n255\r\n12", "2 pixels"),
        (b"P5 2 1 256\n\0\0\0", "1 pixels"),
        (b"P5 2 1 100\n\x64\x65", r"a pixel of 101 \(column 2 of row 1\)"),
        (b"P2 2 2 255 1 2 3", "3 pixels"),
        (b"P2 2 2 255 \n", "0 pixels"),
        (b"P2 3 1 255 1 2 three", r"no number: 'three' \(column 3 of row 1\)"),
        (b"P2 2 2 255 1 2 3 nan", r"no number: 'nan' \(column 2 of row 2\)"),
        (b"P2 2 2 255 1 -2 3 4", r"no number: '-2' \(column 2 of row 1\)"),
        (b"P2 2 2 255 1 2.5 3 4", r"no number: '2.5' \(column 2 of row 1\)"),
        (b"P2 2 2 255 1 1e2 3 4", r"no number: '1e2' \(column 2 of row 1\)"),
        (b"P2 2 1 255 1 2\xff", r"no number: '2\\xff' \(column 2 of row 1\)"),
        (b"P2 2 1 255 1 1000000000", r"a pixel of '1000000000' \(column 2 of row 1\)"),
        (b"P2 2 1 255 1 000" + b"7" * 5000, r"a pixel of '00077777777777777777' \(column 2"),
        (b"P2 1 1 15 16", r"a pixel of 16 \(column 1 of row 1\); at most 15"),
    ],
)  # fmt: skip
def test_a_graymap_that_is_none_is_refused(content: bytes, problem: str) -> None:
    with pytest.raises(MapError, match=problem) as refusal:
        grey(content)
    assert refusal.value.where == "m.pgm"
    assert str(refusal.value).isprintable()
