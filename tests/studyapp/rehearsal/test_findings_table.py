from __future__ import annotations

from dataclasses import replace

from studyapp.rehearsal.findings import Finding, Findings
from studyapp.rehearsal.findings_table import findings_table

WINS = Finding(
    part="",
    question="rhythm",
    measure="win_share",
    about="ours-theirs",
    put_in=0.734,
    found=0.7,
    answers=120,
)


def test_what_was_put_in_stands_beside_what_was_found() -> None:
    ranks = replace(
        WINS, question="realism", measure="mean_rank", about="ours", put_in=None, found=1.5
    )
    said, *rows = findings_table(Findings(excluded=0, rows=(WINS, ranks)))
    assert "no participants excluded" in said
    assert rows == [
        "question  measured           about        put in  found  answers",
        "rhythm    wins of the first  ours-theirs    0.73   0.70      120",
        "realism   mean rank          ours              –   1.50      120",
    ]


def test_parts_are_named_where_the_study_has_any() -> None:
    _, heading, row = findings_table(Findings(excluded=0, rows=(replace(WINS, part="fit"),)))
    assert heading.startswith("part  question")
    assert row.startswith("fit   rhythm")


def test_who_was_left_out_is_counted() -> None:
    said = [next(findings_table(Findings(excluded=count, rows=(WINS,)))) for count in (1, 2)]
    assert "1 participant excluded" in said[0]
    assert "2 participants excluded" in said[1]


def test_nothing_is_shown_where_nothing_was_answered() -> None:
    assert list(findings_table(Findings(excluded=3, rows=()))) == []
