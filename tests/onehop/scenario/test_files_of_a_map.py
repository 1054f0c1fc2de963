"""Where a mission's map and its image are looked for, and what is said when they cannot be read."""

from pathlib import Path

import pytest

from onehop.contracts.errors import ScenarioError
from onehop.maps.map_file import load_map
from onehop.scenario import scenario_file
from tests.onehop.maps.pictures import PGM, YAML


def map_mission(map_file: Path) -> dict[str, bytes]:
    return scenario_file.load_map_mission(map_file, (0.0, 0.0), (1.0, 1.0), [], None).files


def written(folder: Path, yaml: str = YAML) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "m.yaml").write_text(yaml)
    return folder / "m.yaml"


def test_a_relative_image_lies_beside_its_yaml_file(tmp_path: Path) -> None:
    """Also when the scenario lies elsewhere."""
    written(tmp_path / "maps")
    (tmp_path / "maps" / "m.pgm").write_bytes(PGM)
    (tmp_path / "m.pgm").write_bytes(b"another picture")
    scenario = tmp_path / "s.toml"
    scenario.write_text("[map]\nfile = 'maps/m.yaml'\n[goal]\nx = 1\ny = 1\n")
    bundle = scenario_file.load(scenario)
    assert bundle.files["m.pgm"] == PGM
    assert load_map(bundle.scenario.map, bundle.files).bounds == (-1.0, -2.0, 0.5, -1.0)


def test_an_absolute_image_lies_where_it_says(tmp_path: Path) -> None:
    (tmp_path / "far.pgm").write_bytes(PGM)
    path = written(tmp_path / "maps", YAML.replace("m.pgm", str(tmp_path / "far.pgm")))
    assert map_mission(path)[str(tmp_path / "far.pgm")] == PGM


@pytest.mark.parametrize(
    ("image", "problem"),
    [
        ("gone.pgm", r"gone\.pgm: No such file"),
        (".", "not a regular file"),
        ("/dev/zero", "/dev/zero: not a regular file"),
        ("x" * 300, "File name too long"),
    ],
)
def test_an_image_that_cannot_be_read_is_refused_by_its_key(
    tmp_path: Path, image: str, problem: str
) -> None:
    path = written(tmp_path / "maps", YAML.replace("m.pgm", image))
    with pytest.raises(ScenarioError, match=problem) as refusal:
        map_mission(path)
    assert refusal.value.where == f"{path}: image"
    assert refusal.value.remedy == "an image that exists, named absolutely or from the folder of m.yaml"


@pytest.mark.parametrize("name", ["m\\u0000.yaml", "m\\nm.yaml", "."])
def test_a_map_that_cannot_be_read_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    scenario = tmp_path / "s.toml"
    scenario.write_text(f'[map]\nfile = "{name}"\n[goal]\nx = 1\ny = 1\n')
    with pytest.raises(ScenarioError, match=r"map\.file: ") as refusal:
        scenario_file.load(scenario)
    assert str(refusal.value).isprintable()


def test_a_file_larger_than_any_map_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "large.map"
    with path.open("wb") as file:
        file.truncate((1 << 28) + 1)
    with pytest.raises(ScenarioError, match="larger than 268435456 bytes"):
        map_mission(path)
