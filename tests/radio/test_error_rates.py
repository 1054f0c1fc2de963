"""Frame success of every modulation against ns-3's DsssErrorRateModel (n = 6672 bits)."""

import pytest

from radio_proxy.core.error_rates import (
    CERTAIN_SINR_DB,
    bit_error_rate,
    cck55_symbol_error,
    frame_success,
    thesis_ber,
)

BITS = 6672
RATES = (1.0, 2.0, 5.5, 11.0)

# dB: success at 1, 2, 5.5 and 11 Mb/s as printed; None where the table says "about 0".
TABLE: dict[int, tuple[str | None, ...]] = {
    -6: ("1.683e-6", None, None, None),
    -5: (".0417348", None, None, None),
    -4: (".592000", None, None, None),
    -3: (".947166", "1e-20", None, None),
    -2: (".996881", "2.2e-8", None, None),
    0: (".999999", ".273662", "2.5e-18", None),
    1: ("1", ".804336", "6.5e-7", None),
    2: ("1", ".976526", ".0229271", "4e-41"),
    3: ("1", ".998497", ".496893", "1.7e-18"),
    4: ("1", ".999952", ".920432", "5.4e-7"),
    5: ("1", ".999999", ".994366", ".0216251"),
    6: ("1", "1", ".999806", ".490106"),
    8: ("1", "1", "1", ".994190"),
}
CELLS = [(db, rate, cell) for db, row in TABLE.items() for rate, cell in zip(RATES, row, strict=True)]


def half_digit(printed: str) -> float:
    """Half a unit of the last digit that a table prints."""
    mantissa, _, exponent = printed.partition("e")
    digits = len(mantissa.partition(".")[2])
    return float(0.5 * 10.0 ** (int(exponent or 0) - digits))


@pytest.mark.parametrize(("db", "rate", "printed"), CELLS)
def test_frame_success_to_the_printed_digits(db: int, rate: float, printed: str | None) -> None:
    success = frame_success(rate, db, BITS)
    if printed is None:
        assert success < 1e-20
    elif printed == "1":
        assert success == pytest.approx(1.0, abs=1e-6)
    else:
        assert success == pytest.approx(float(printed), abs=half_digit(printed) * 1.01)


@pytest.mark.parametrize("rate", RATES)
def test_above_20_db_no_frame_is_lost_to_bits(rate: float) -> None:
    assert 1.0 - frame_success(rate, CERTAIN_SINR_DB - 1e-9, 8 * 2338) < 1e-12


@pytest.mark.parametrize("rate", RATES)
def test_bit_errors_fall_with_the_signal(rate: float) -> None:
    errors = [bit_error_rate(rate, db / 2.0) for db in range(-40, 45)]
    assert errors == sorted(errors, reverse=True)
    assert all(0.0 <= error <= 0.5 for error in errors)


def test_without_signal_a_cck_symbol_is_a_guess_among_sixteen() -> None:
    assert cck55_symbol_error(0.0) == pytest.approx(15.0 / 16.0, abs=0.07)


def test_the_thesis_formula_draws_its_curves() -> None:
    """0.390 at 32 dB, 0.105 at 40 dB with 800 B (eq. 3.25)."""
    assert thesis_ber(32.0, 6400) == pytest.approx(0.390, abs=5e-4)
    assert thesis_ber(40.0, 6400) == pytest.approx(0.105, abs=5e-4)
