"""What the thesis reports of its missions: one run a cell, in figures and in the text of 4.2."""

from typing import NamedTuple

from onehop.study.chapter4.missions import CONSTANT, VARIABLE


class Reported(NamedTuple):
    """One cell of 4.2. lost: how many followers, None if not said. words: who, and the shape after it.

    figure: where it is shown. Differs: three captions repeat an earlier number, and the text counts on;
    the numbers here are the text's.
    """

    lost: int | None
    words: str
    figure: str


REPORTED: dict[tuple[str, str, str], Reported] = {
    ("map1", "mrsr", CONSTANT): Reported(1, "robot 6; wedge", "fig. 4.3 a, 4.2.1"),
    ("map1", "mrsr", VARIABLE): Reported(0, "none", "fig. 4.3 b, 4.2.1"),
    ("map1", "mrdv", CONSTANT): Reported(1, "robot 6; wedge", "fig. 4.6 a, 4.2.1"),
    ("map1", "mrdv", VARIABLE): Reported(0, "none", "fig. 4.6 b, 4.2.1"),
    ("map2", "mrsr", CONSTANT): Reported(3, "robots 1, 5, 6; wedge", "fig. 4.9 a, 4.2.2"),
    ("map2", "mrsr", VARIABLE): Reported(0, "none", "fig. 4.9 b, 4.2.2"),
    ("map2", "mrdv", CONSTANT): Reported(2, "two robots", "fig. 4.12 a, 4.2.2"),
    ("map2", "mrdv", VARIABLE): Reported(0, "none", "fig. 4.12 b, 4.2.2"),
    ("map3", "mrsr", CONSTANT): Reported(3, "three robots", "fig. 4.15 a, 4.2.3"),
    ("map3", "mrsr", VARIABLE): Reported(0, "none", "fig. 4.15 b, 4.2.3"),
    ("map3", "mrdv", CONSTANT): Reported(4, "robots 1, 2, 5, 6; column", "fig. 4.18 a, 4.2.3"),
    ("map3", "mrdv", VARIABLE): Reported(
        None, "not said; less throughput than MRSR", "fig. 4.18 b, 4.2.3"
    ),
}
"""By map, routing and `gains.policy`.

The team of map 2 under MRSR has three robots left after it lost three, a wedge; that of map 3 under MRDV
has two, a column.
"""
