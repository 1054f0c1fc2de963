"""`onehop link` and `onehop saturate`: the radio model in tables, from the code that flies missions."""

from dataclasses import asdict, replace

from onehop.commands.numbers import DISTANCE, require_within
from onehop.commands.output import emit_json, stdout, table
from onehop.contracts.errors import InputError
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.link_tables import link_table, saturation_table

RATES = (1.0, 2.0, 5.5, 11.0)


def link(
    distances: str,
    preset: str,
    fast_fading: str,
    rate: float,
    msdu: int,
    seed: int,
    seconds: float,
    as_json: bool,
) -> int:
    """Print the link budget over distance."""
    _require_rate(rate)
    section = RadioSection(preset=preset, fast_fading=fast_fading, rate_mbps=rate)  # type: ignore[arg-type]
    made = link_table(section, _distances(distances), msdu, seed, seconds)
    if as_json:
        emit_json(asdict(made))
        return 0
    rows = table(
        f"Link at {rate:g} Mb/s, {msdu} B, preset {preset}, fast fading {fast_fading}",
        "distance m", "SNR dB", "BER", *(("good places", "9 of 10 Mb/s") if made.places_differ else
        ("thesis BER",)), "frame success", "theory Mb/s", "Mb/s", "delivery", "delay ms",
    )  # fmt: skip
    for row in made.rows:
        places = f"{row.good_places:.3f}", f"{row.nine_of_ten_bps / 1e6:.4f}"
        rows.add_row(
            f"{row.distance_m:g}",
            f"{row.snr_db:.1f}",
            f"{row.ber:.1e}",
            *(places if made.places_differ else (f"{row.thesis_ber:.3f}",)),
            f"{row.frame_success:.4f}",
            f"{row.closed_form_bps / 1e6:.4f}",
            f"{row.throughput_bps / 1e6:.4f}",
            f"{row.delivery_ratio:.4f}",
            "-" if row.delay_us is None else f"{row.delay_us / 1e3:.2f}",
        )
    stdout().print(rows)
    print(f"ideal      {made.ideal_throughput_bps / 1e6:.4f} Mb/s (full exchange)")
    print(f"eq 3.16    {made.eq_3_16_throughput_bps / 1e6:.4f} Mb/s (as printed in the thesis)")
    print(f"threshold  {made.threshold_bps / 1e6:.4f} Mb/s")
    return 0


def saturate(
    stations: int, rts: bool, rate: float, msdu: int, seed: int, seconds: float, as_json: bool
) -> int:
    """Print the throughput of saturated stations in one cell, measured and by Bianchi's formula."""
    _require_rate(rate)
    section = replace(RadioSection(), rate_mbps=rate)
    made = saturation_table(section, stations, msdu, rts, seed, seconds)
    if as_json:
        emit_json(asdict(made))
        return 0
    access = "RTS/CTS" if rts else "basic access"
    shares = made.per_station_bps
    print(f"{stations} saturated stations, {rate:g} Mb/s, {msdu} B, {access}, {seconds:g} s simulated")
    print(f"throughput   {made.throughput_bps / 1e6:.4f} Mb/s")
    print(f"normalized   {made.normalized:.4f}")
    print(f"Bianchi      {made.bianchi_normalized:.4f}")
    print(f"per station  {min(shares) / 1e6:.4f} to {max(shares) / 1e6:.4f} Mb/s")
    return 0


def _require_rate(rate: float) -> None:
    if rate not in RATES:
        raise InputError(f"--rate {rate:g}", "is no rate of 802.11b", "1, 2, 5.5 or 11")


def _distances(text: str) -> tuple[float, ...]:
    try:
        distances = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"--distance {text!r}", "is no list of distances", "metres, e.g. 5,10,20"
        ) from None
    for distance in distances:
        require_within(DISTANCE, "--distance", distance)
    return distances
