"""One colour for each robot, the same in every figure, film and viewer.

The colours of Okabe and Ito (2008) stay apart for every common kind of colour blindness; the yellow is
darkened because it vanishes on white paper. Teams of more than eight get colours of rising lightness
from the same hues; robots with the same colour never have neighbouring ids.
"""

import colorsys

OKABE_ITO = (
    "#0072B2",  # blue
    "#E69F00",  # orange
    "#009E73",  # bluish green
    "#CC79A7",  # reddish purple
    "#56B4E9",  # sky blue
    "#D55E00",  # vermilion
    "#5B5B5B",  # grey in place of black, which the figures' ink uses
    "#B8A800",  # yellow, darkened
)

INK = "#222222"
FAINT = "#9A9A9A"
WALL = "#D8D4CC"
WALL_EDGE = "#6B675F"
GOOD = "#009E73"
BAD = "#B2182B"

_LIGHTNESS = (1.0, 0.62, 1.35)


def robot_colours(robots: tuple[int, ...]) -> dict[int, str]:
    """The colour of each robot of a team, "#rrggbb"."""
    return {robot: _shade(place) for place, robot in enumerate(sorted(robots))}


def _shade(place: int) -> str:
    base = OKABE_ITO[place % len(OKABE_ITO)]
    factor = _LIGHTNESS[place // len(OKABE_ITO) % len(_LIGHTNESS)]
    r, g, b = (int(base[i : i + 2], 16) / 255 for i in (1, 3, 5))
    hue, lightness, saturation = colorsys.rgb_to_hls(r, g, b)
    shaded = colorsys.hls_to_rgb(hue, min(0.85, lightness * factor), saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in shaded)


def rgb(colour: str) -> tuple[float, float, float]:
    """Red, green and blue of "#rrggbb", each 0..1."""
    r, g, b = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return r, g, b
