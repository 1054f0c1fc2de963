"""The least time that a message needs on the air (IEEE 802.11-1999, 9.2, 15.2 and 18.2; thesis 3.7).

Nobody waits and nothing is lost: no DIFS, no backoff, no repetition. What a NIC adds to a message
(routing headers) only makes it longer.
"""

from onehop.contracts.radio_section import RadioSection

_PREAMBLE_NS = 192_000
_SIFS_NS = 10_000
_RTS_NS = _PREAMBLE_NS + 20 * 8_000
_CTS_NS = _PREAMBLE_NS + 14 * 8_000
"""Long preamble, and control frames of 20 and 14 bytes at 1 Mb/s [ns]."""


class Airtimes:
    """Least airtimes under one radio section [ns]."""

    def __init__(self, radio: RadioSection) -> None:
        self._header_bytes = radio.mac_header_bytes
        self._rate_mbps = radio.rate_mbps
        self._rts_threshold_bytes = radio.rts_threshold_bytes

    def frame_ns(self, msdu_bytes: int, is_broadcast: bool) -> int:
        """The data frame alone; broadcasts go at the basic rate of 1 Mb/s."""
        rate_mbps = 1.0 if is_broadcast else self._rate_mbps
        return _PREAMBLE_NS + int(8_000 * (self._header_bytes + msdu_bytes) / rate_mbps)

    def message_ns(self, msdu_bytes: int, is_broadcast: bool, hops: int) -> int:
        """From the beginning of service to the last bit at the receiver, over so many hops."""
        hop = self.frame_ns(msdu_bytes, is_broadcast)
        if not is_broadcast and msdu_bytes > self._rts_threshold_bytes:
            hop += _RTS_NS + _CTS_NS + 2 * _SIFS_NS
        return hops * hop
