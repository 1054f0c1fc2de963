"""A page shows words as words, whoever said them, and needs no network."""

from pathlib import Path

from onehop.study import page
from onehop.study.claims import Claim, Expects, judge
from onehop.study.page import Cell, Picture
from onehop.study.statistics import Estimate

EVIL = "<script>alert(1)</script>\x1b[31m"


def test_words_are_never_markup(tmp_path: Path) -> None:
    figure = tmp_path / "figure.png"
    figure.write_bytes(b"\x89PNG")
    claim = Claim(EVIL, EVIL, "lost", Expects.LESS, EVIL)
    body = [
        page.heading(EVIL),
        page.paragraph(EVIL),
        page.definitions([(EVIL, EVIL)]),
        page.rows([Cell(EVIL)], [("", [Cell(EVIL, is_text=True)])]),
        page.claims([judge(claim, Estimate(-1.0, -2.0, -0.5), 9)]),
        page.picture(Picture(EVIL, EVIL, figure)),
    ]
    path = tmp_path / "page.html"
    page.write_page(path, EVIL, EVIL, body)
    written = path.read_text(encoding="utf-8")
    assert written.count("&lt;script&gt;") >= 12
    assert "<script" not in written
    assert "\x1b" not in written
    assert "http" not in written
    assert 'src="data:image/png;base64,iVBORw=="' in written


def test_verdicts_are_counted_in_words() -> None:
    claim = Claim("so", "4.2", "lost", Expects.LESS)
    found = [judge(claim, Estimate(sign, sign, sign), 9) for sign in (-1.0, -1.0, 1.0)]
    assert page.verdicts(found) == "2 confirmed, 1 refuted"
