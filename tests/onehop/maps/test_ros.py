"""What a map_server file makes of a picture: modes, thresholds, transparency, maps without ground."""

import numpy as np
import pytest

from onehop.contracts.errors import MapError
from tests.onehop.maps.pictures import YAML, cells, encoded, png, ros


@pytest.mark.parametrize(("free_thresh", "row"), [("0.196", ".xx"), ("0.25", ".x.")])
def test_grey_205_is_unknown_or_free_by_free_thresh(free_thresh: str, row: str) -> None:
    """(255 - 205) / 255 = 0.19608: the reason for ROS's odd default of 0.196."""
    assert cells(ros(YAML.replace("0.196", free_thresh)))[0] == row


def test_negate_turns_brightness_round() -> None:
    assert cells(ros(YAML.replace("negate: 0", "negate: 1"))) == ["x.x", "xxx"]


@pytest.mark.parametrize(("free_thresh", "row"), [("0.2", ".."), ("0.19999", ".x")])
def test_a_pixel_at_the_free_threshold_is_free(free_thresh: str, row: str) -> None:
    """nav2 compares with <=, in single precision: 1 - 204 / 255 is 0.2 there."""
    assert cells(ros(YAML.replace("0.196", free_thresh), b"P2 2 1 255 255 204")) == [row]


def test_a_pixel_at_the_occupied_threshold_is_a_wall_in_scale_mode() -> None:
    yaml = YAML.replace("0.65", "0.4").replace("0.196", "0.39999") + "mode: scale\n"
    assert cells(ros(yaml, b"P2 3 1 255  255 153 154")) == [".x."]


def test_scale_mode_calls_half_occupied_a_wall() -> None:
    yaml = YAML.replace("0.65", "0.9").replace("0.196", "0.1") + "mode: scale\n"
    image = b"P2 4 1 255  255 140 115 0"
    assert cells(ros(yaml, image)) == ["..xx"]


def test_raw_mode_reads_occupancy_of_a_hundred_and_more_is_unknown() -> None:
    image = b"P2 8 1 255  0 49 50 100 101 127 128 255"
    assert cells(ros(YAML + "mode: raw\n", image)) == ["..xxxxxx"]


def test_raw_mode_knows_no_negate() -> None:
    yaml = YAML.replace("negate: 0", "negate: 1") + "mode: raw\n"
    assert cells(ros(yaml, b"P2 2 1 255  0 100")) == [".x"]


OPAQUE = [[(254, 255), (0, 255), (205, 255)], [(33, 255)] * 3]


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
@pytest.mark.parametrize("colour_type", [4, 6], ids=["grey", "colour"])
def test_an_opaque_pixel_keeps_its_grey(mode: str, colour_type: int) -> None:
    """As GIMP and Photoshop write maps: with an alpha channel that says nothing."""
    yaml = YAML + f"mode: {mode}\n"
    channels = 1 if colour_type == 4 else 3
    image = png([[(grey,) * channels + (alpha,) for grey, alpha in row] for row in OPAQUE], colour_type)
    plain = png([[(grey,) for grey, _ in row] for row in OPAQUE], 0)
    np.testing.assert_array_equal(ros(yaml, image).segments, ros(yaml, plain).segments)


@pytest.mark.parametrize(("mode", "row"), [("trinary", ".xx."), ("scale", ".xx."), ("raw", "....")])
def test_a_pixel_that_is_not_opaque_is_unknown_but_in_raw_mode(mode: str, row: str) -> None:
    white = 0 if mode == "raw" else 254
    image = png([[(white, 255), (white, 254), (white, 0), (white, 255)]], 4)
    assert cells(ros(YAML + f"mode: {mode}\n", image)) == [row]


@pytest.mark.parametrize("file_format", ["BMP", "PNG"])
def test_colours_are_read_by_their_luma(file_format: str) -> None:
    """ITU-R BT.601, as GraphicsMagick: yellow 226 is free, green 149 and pure red 76 are not."""
    row = [(255, 255, 0), (0, 255, 0), (255, 0, 0), (255, 255, 255)]
    assert cells(ros(image=encoded([row], "RGB", file_format))) == [".xx."]


@pytest.mark.parametrize(
    ("yaml", "image", "reason"),
    [
        (YAML + "mode: raw\n", b"P2 2 1 255  205 254", "by mode raw a pixel is free where grey < 50"),
        (
            YAML,
            b"P2 2 1 255 205 9",
            "1 - grey / 255 <= free_thresh 0.196, and it has greys from 9 to 205",
        ),
        (YAML.replace("negate: 0", "negate: 1"), b"P2 2 1 255  205 254", "negate 1 a pixel is free"),
        (YAML + "mode: scale\n", b"P2 1 1 255  0", "1 - grey / 255 < 0.423"),
        (YAML, png([[(254, 7)]], 4), "and opaque"),
    ],
    ids=["raw", "trinary", "negate", "scale", "transparent"],
)
def test_a_map_without_ground_is_refused_by_how_it_is_read(yaml: str, image: bytes, reason: str) -> None:
    with pytest.raises(MapError) as refusal:
        ros(yaml, image)
    assert refusal.value.where == "m.yaml: mode"
    assert "every pixel of m.pgm is a wall or unknown" in refusal.value.problem
    assert reason in refusal.value.remedy


def test_thresholds_that_are_one_in_single_precision_leave_nothing_between() -> None:
    yaml = YAML.replace("0.65", "0.19600000001") + "mode: scale\n"
    assert cells(ros(yaml, b"P2 3 1 255  255 206 205")) == ["..x"]


def test_a_picture_of_noise_is_refused_before_it_takes_all_memory() -> None:
    noise = np.random.default_rng(1).integers(0, 2, (2048, 2048), dtype=np.uint8) * 255
    with pytest.raises(MapError, match=r"m\.yaml: \d+ straight pieces of wall; at most 1048576"):
        ros(image=b"P5 2048 2048 255\n" + noise.tobytes())
