"""The picture of the floors shows the rooms that the layers contract holds."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_the_picture_shows_every_room_of_the_layers_contract_on_its_floor() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    contract = project["tool"]["importlinter"]["contracts"][0]
    layers = [set(line.split(" | ")) for line in contract["layers"]]
    picture = (ROOT / "docs" / "floors.svg").read_text()
    shown: dict[str, int] = {}
    for height, names in re.findall(r'y="(\d+)" font-weight="bold">([^<]+)<', picture):
        stem, _, inner = names.partition(".{")
        for name in [f"{stem}.{part}" for part in inner.strip("}").split(", ")] if inner else [names]:
            shown[name] = int(height)
    assert set(shown) == set().union(*layers)
    programs = {shown[name] for name in ("robot_agent", "world_server", "radio_proxy")}
    assert len(programs) == 1
    place = next(number for number, rooms in enumerate(layers) if "robot_agent" in rooms)
    assert all(shown[name] < min(programs) for rooms in layers[:place] for name in rooms)
    assert all(shown[name] > max(programs) for rooms in layers[place + 1 :] for name in rooms)
