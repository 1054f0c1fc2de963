"""What a scenario may not ask of the radio."""

import pytest

from onehop.contracts.radio_section import RadioSection
from onehop.contracts.ranges import out_of_range


def test_the_defaults_are_sound() -> None:
    assert not list(RadioSection().problems())
    assert not list(RadioSection(preset="physical", rate_mbps=11.0, routing="direct").problems())


@pytest.mark.parametrize(
    "wrong",
    [
        {"rate_mbps": 6.0},
        {"retry_limit": 0},
        {"frequency_hz": 0.0},
        {"reference_distance": -1.0},
        {"mac_header_bytes": 0},
        {"queue_frames": 0},
        {"gamma_distance": 0.0},
        {"wall_loss_db": -1.0},
        {"rts_threshold_bytes": -1},
        {"shadowing_db": -4.0},
        {"path_loss_exponent": 0.5},
        {"cts_timeout_us": 100.0},
    ],
)
def test_a_wrong_value_is_named(wrong: dict[str, float]) -> None:
    section = RadioSection(**wrong)  # type: ignore[arg-type]
    (problem, *_) = [*out_of_range(section), *section.problems()]
    assert problem.key == next(iter(wrong))
