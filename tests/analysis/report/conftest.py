from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import pytest
from bs4 import BeautifulSoup

from analysis.report import ReportInputs, write_report
from analysis.responses import responses_frame

VOID = {"meta", "br", "hr", "img", "link", "input", "col", "wbr"}


class _Nesting(HTMLParser):
    """Fail on any element that is not closed where it was opened."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.open = []

    def handle_starttag(self, tag, attrs):
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), f"<{tag}> repeats an attribute"
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag, f"</{tag}> is out of place at {self.getpos()}"


@pytest.fixture
def open_page():
    """Return a reader of report pages that insists on well-formed HTML."""

    def read(path: Path) -> BeautifulSoup:
        text = path.read_text(encoding="utf-8")
        nesting = _Nesting()
        nesting.feed(text)
        assert nesting.open == []
        return BeautifulSoup(text, "html.parser")

    return read


@pytest.fixture
def by_hand(answer) -> ReportInputs:
    """Return a study small enough to work every number out by hand.

    Three participants answer one question about two segments, a fourth fails the catch trial.
    Towards the reference the three say 2 1 | 1 0 | -1 2; the fourth says -2 -2.
    """
    rows = []
    answers = {"s1": (2, 1), "s2": (1, 0), "s3": (-1, 2), "s4": (-2, -2)}
    for session, towards in answers.items():
        for place, (segment, value) in enumerate(zip("ab", towards, strict=True), start=1):
            on_left = place == 1
            rows.append(
                answer(
                    study_session=session,
                    segment=segment,
                    position=place,
                    value=-value if on_left else value,
                    left_condition="ours" if on_left else "other",
                    right_condition="other" if on_left else "ours",
                )
            )
        rows.append(
            answer(
                study_session=session,
                kind="catch",
                position=3,
                other="broken",
                left_condition="ours",
                right_condition="broken",
                expected="left",
                value=0 if session == "s4" else -2,
            )
        )
    return ReportInputs(
        title="By hand",
        origin="participants",
        reference="ours",
        catch_reference="ours",
        catch_condition="broken",
        conditions=("ours", "other"),
        questions={"synchronisation": "Which fits better?"},
        max_failed_catch=0,
        responses=responses_frame(rows),
        presentations=3,
    )


@pytest.fixture
def report_page(tmp_path, open_page):
    """Return a writer of reports that gives back the page, read and checked."""
    return lambda inputs: open_page(write_report(inputs, tmp_path / "report"))
