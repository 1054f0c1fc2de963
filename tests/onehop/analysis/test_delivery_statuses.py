"""Whatever can become of a message has a sentence, a colour and a line in the documentation."""

from pathlib import Path

from onehop.analysis.explanation_text import WHY_LOST
from onehop.analysis.report.radio_chart import COLOURS
from onehop.contracts.messages import DeliveryStatus

DOCS = Path(__file__).parents[3] / "docs" / "reading-logs.md"
LOST = [status for status in DeliveryStatus if status is not DeliveryStatus.DELIVERED]


def test_every_reason_of_a_loss_has_a_sentence_and_a_colour_of_its_own() -> None:
    assert list(WHY_LOST) == list(COLOURS) == LOST
    assert len(set(WHY_LOST.values())) == len(set(COLOURS.values())) == len(LOST)


def test_the_documentation_lists_every_status() -> None:
    rows = [line.split("`")[1] for line in DOCS.read_text().splitlines() if line.startswith("| `")]
    assert [name for name in rows if name in set(DeliveryStatus)] == list(DeliveryStatus)
