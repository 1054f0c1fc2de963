"""The YAML of map_server files as yaml-cpp converts it, and what is refused by key and line."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.errors import MapError
from onehop.contracts.ranges import Range
from onehop.maps.map_file import map_files
from onehop.maps.map_yaml import MapYaml
from tests.onehop.maps.pictures import YAML, cells, ros

ANY = Range(-1e9, 1e9)


def number(text: str) -> float:
    return MapYaml("m.yaml", f"a: {text}\n".encode()).number("a", ANY, "a number")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-05", 1e-5),
        ("25e-2", 0.25),
        ("1E3", 1000.0),
        (".5", 0.5),
        ("-.5", -0.5),
        ("+1", 1.0),
        ("5.", 5.0),
        ("010", 10.0),
        ("'0.25'", 0.25),
        ('"0.25"', 0.25),
        ('"0.25 "', 0.25),
        ("!!str 0.25", 0.25),
        ("0.25\t# a comment", 0.25),
        ("|\n  0.25\n", 0.25),
        ("&x 0.25\nb: *x", 0.25),
    ],
)
def test_a_number_is_read_by_its_text(text: str, value: float) -> None:
    assert number(text) == value


@pytest.mark.parametrize(
    "text",
    [".inf", "-.INF", ".nan", "nan", "inf", "0x10", "0o17", "1_000", "1,5", "1e", "e1", ".", "+", "--1",
     "1.5.2", "1:30", "0.5f", '" 0.5"', "no", "true", "~", "", "[1]", "{b: 1}", "\uff11"],
)  # fmt: skip
def test_what_yaml_cpp_takes_for_no_number_is_none(text: str) -> None:
    with pytest.raises(MapError) as refusal:
        number(text)
    assert refusal.value.where == "m.yaml: a"
    assert "no number" in refusal.value.problem


@pytest.mark.parametrize("text", ["1e10", "-1e400", "9" * 5000])
def test_a_number_beyond_its_limits_is_refused_with_them(text: str) -> None:
    with pytest.raises(
        MapError, match=r"m\.yaml: a: .* is out of range; a number, from -1e\+09 to 1e\+09"
    ):
        number(text)


@given(st.floats(-1e9, 1e9))
def test_every_float_that_a_program_prints_is_read_back(value: float) -> None:
    assert number(repr(value)) == value
    assert number(f"'{value!r}'") == value


@pytest.mark.parametrize(
    ("words", "value"),
    [
        (
            ["0", "'0'", "00", "-0", "0x0", "0x00", "no", "No", "NO", "n", "N", "false", "off", "Off"],
            False,
        ),
        (
            ["1", '"1"', "+1", "2", "-1", "01", "0x1", "2147483647", "yes", "Y", "true", "TRUE", "On"],
            True,
        ),
    ],
    ids=["false", "true"],
)
def test_negate_is_a_whole_number_or_a_word(words: list[str], value: bool) -> None:
    for word in words:
        assert MapYaml("m.yaml", f"a: {word}\n".encode()).flag("a") is value


@pytest.mark.parametrize(
    "word", ["maybe", "tRue", "0.0", "1.0", "08", "2147483648", "9" * 5000, "~", "", "[0]", "0b1"]
)
def test_other_values_of_negate_are_refused(word: str) -> None:
    with pytest.raises(MapError, match=r"m\.yaml: a: .*; 0 or 1"):
        MapYaml("m.yaml", f"a: {word}\n".encode()).flag("a")


@pytest.mark.parametrize("mode", ["Trinary", "TRINARY", "'trinary'", '"Trinary"'])
def test_the_mode_is_read_in_any_case(mode: str) -> None:
    assert cells(ros(YAML + f"mode: {mode}\n")) == cells(ros())


@pytest.mark.parametrize(
    "yaml",
    [
        YAML.replace(": ", ":\t"),
        YAML.replace("\n", "\t\n"),
        YAML.replace("\n", "\r\n"),
        "\ufeff" + YAML,
        "%YAML 1.2\n---\n" + YAML + "...\n",
        YAML + "---\nimage: other.pgm\nnot: [closed\n",
        "\t\n\t# a comment\n" + YAML,
        YAML.replace("[-1.0, -2.0, 0.0]", "\n- -1\n- -2e0\n-\t0"),
        YAML.replace("[-1.0, -2.0, 0.0]", "[\n\t-1.0,\n\t-2.0,\n\t0.0\n\t]"),
        "{" + ", ".join(YAML.strip().split("\n")) + "}",
        YAML.replace("image:", "'image':"),
        "cell: &cell 0.5\n" + YAML.replace("resolution: 0.5", "resolution: *cell"),
        YAML + "creator: {name: [a, b], deep: [[[1]]]}\n1: 2\n[1, 2]: 3\n~: 4\n",
    ],
    ids=["tabs", "tabs at line ends", "CRLF", "byte order mark", "directive", "a second document",
         "lines of tabs", "block list", "flow list with tabs", "flow table", "quoted key", "alias",
         "keys of others"],
)  # fmt: skip
def test_yaml_that_ros_reads_is_the_same_map(yaml: str) -> None:
    assert cells(ros(yaml)) == cells(ros())


@pytest.mark.parametrize(
    ("name", "image"),
    [
        ("m.pgm", "m.pgm"),
        ("'a b.png'", "a b.png"),
        ("/maps/x.bmp", "/maps/x.bmp"),
        ("../m.pgm", "../m.pgm"),
        ("3", "3"),
        ("no", "no"),
        ("a#b", "a#b"),
        ("\u00e9.pgm", "\u00e9.pgm"),
        ('"\\u00e9.pgm"', "\u00e9.pgm"),
    ],
)
def test_an_images_name_is_taken_as_it_stands(name: str, image: str) -> None:
    assert map_files("m.yaml", YAML.replace("m.pgm", name).encode()) == (image,)


NO_NAMES = [
    '""',
    "''",
    '"m\\0.pgm"',
    '"m\\n"',
    '"\\ud800"',
    '"\\e[31m"',
    '"\\u202e"',
    "x" * 5000,
]


@pytest.mark.parametrize("name", NO_NAMES)
def test_what_no_file_is_called_is_no_images_name(name: str) -> None:
    with pytest.raises(
        MapError, match=r"m\.yaml: image: .* is no file name; the name of a PGM"
    ) as refusal:
        map_files("m.yaml", YAML.replace("m.pgm", name).encode())
    assert str(refusal.value).isprintable()
    assert len(str(refusal.value)) < 200


@pytest.mark.parametrize(
    ("yaml", "where", "problem"),
    [
        ("a: [", "m.yaml", "not YAML"),
        ("a: [\n", "m.yaml", "line 2"),
        ('a: "\\U00110000"', "m.yaml", "not YAML"),
        ('a: "\\UFFFFFFFF"', "m.yaml", "not YAML"),
        ("a: *b", "m.yaml", "undefined alias"),
        ("", "m.yaml", "not a table of keys"),
        ("- 1", "m.yaml", "not a table of keys"),
        ("image", "m.yaml", "not a table of keys"),
        (YAML + "\tmode: raw\n", "m.yaml", "a tab in line 7"),
        (YAML + "creator:\n  x:\n\t- 1\n    y: 1\n", "m.yaml", "a tab in line 9"),
        (YAML + "x" * 70000, "m.yaml", "bytes; a map_server YAML file of at most 65536"),
        (YAML.replace("image: m.pgm", "image: [3]"), "m.yaml: image", "[3]"),
        (YAML.replace("image: m.pgm", "image:"), "m.yaml: image", "no value"),
        (YAML.replace("image: m.pgm", ""), "m.yaml: image", "missing"),
        (YAML + "mode: fancy", "m.yaml: mode", "'fancy'"),
        (YAML + "mode: [raw]", "m.yaml: mode", "raw"),
        (YAML + "mode:", "m.yaml: mode", "no value"),
        (YAML.replace("negate: 0", "negate: maybe"), "m.yaml: negate", "'maybe'"),
        (YAML.replace("negate: 0", ""), "m.yaml: negate", "missing"),
        (YAML.replace("resolution: 0.5", "resolution: 0"), "m.yaml: resolution", "0"),
        (YAML.replace("resolution: 0.5", "resolution: -0.05"), "m.yaml: resolution", "out of range"),
        (YAML.replace("resolution: 0.5", "resolution: 1e300"), "m.yaml: resolution", "out of range"),
        (YAML.replace("resolution: 0.5", "resolution: fine"), "m.yaml: resolution", "'fine'"),
        (YAML.replace("resolution: 0.5", ""), "m.yaml: resolution", "missing"),
        (YAML + "resolution: 0.25\n", "m.yaml: resolution", "stands in line 2 and again in line 7"),
        (YAML + "'negate': 1\n", "m.yaml: negate", "stands in line 4 and again in line 7"),
        (YAML.replace("-2.0, ", ""), "m.yaml: origin", "-1.0, 0.0"),
        (YAML.replace("[-1.0, -2.0, 0.0]", "[no, no, no]"), "m.yaml: origin", "[no, no, no]"),
        (YAML.replace("[-1.0, -2.0, 0.0]", "[[0], 0, 0]"), "m.yaml: origin", "[..., 0, 0]"),
        (YAML.replace("[-1.0, -2.0, 0.0]", "&o [*o, 0, 0]"), "m.yaml: origin", "[..., 0, 0]"),
        (YAML.replace("[-1.0, -2.0, 0.0]", "0"), "m.yaml: origin", "0"),
        (YAML.replace("[-1.0, -2.0, 0.0]", "{x: 0}"), "m.yaml: origin", "a table"),
        (YAML.replace("-2.0", ".nan"), "m.yaml: origin", "nan"),
        (YAML.replace("-2.0", "2e7"), "m.yaml: origin", "2e+07 is out of range"),
        (YAML.replace("free_thresh: 0.196\n", "free_tresh: 0.3\n"), "m.yaml: free_thresh", "missing"),
        (YAML.replace("0.196", "0.7"), "m.yaml: free_thresh", "0.7"),
        (YAML.replace("0.196", "65"), "m.yaml: free_thresh", "out of range"),
        (YAML.replace("0.65", "0.196"), "m.yaml: free_thresh", "not below occupied_thresh"),
    ],
)
def test_a_bad_yaml_file_is_refused_by_key(yaml: str, where: str, problem: str) -> None:
    with pytest.raises(MapError) as refusal:
        map_files("m.yaml", yaml.encode())
    assert refusal.value.where == where
    assert problem in str(refusal.value)
    assert str(refusal.value).isprintable()
    assert len(str(refusal.value)) < 250


@pytest.mark.parametrize("nest", ["[", "{a: ", "- ", "? "])
def test_deep_nesting_is_refused(nest: str) -> None:
    with pytest.raises(MapError, match=r"m\.yaml: not YAML \(.*50 deep"):
        map_files("m.yaml", f"x:\n  {3000 * nest}\n".encode())
