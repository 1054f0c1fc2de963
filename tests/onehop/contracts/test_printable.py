"""What others say is one line on a terminal and moves no cursor."""

import pytest

from onehop.contracts.printable import printable


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        ("Ümläut, 東京, 5 °C", "Ümläut, 東京, 5 °C"),
        ("two\nlines\r\n", r"two\nlines\r\n"),
        ("\x1b[31mred\x07", r"\x1b[31mred\x07"),
        ("\u202ereversed", r"\u202ereversed"),
        ("\udcff.toml", r"\udcff.toml"),
    ],
)
def test_what_does_not_print_is_escaped(said: str, shown: str) -> None:
    assert printable(said) == shown
