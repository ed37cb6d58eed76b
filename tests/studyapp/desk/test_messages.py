"""Messages of commands are adapted to the desk, which has no options."""

import re
from pathlib import Path

import pytest

import studyapp
from studyapp.desk.page import at_the_desk


@pytest.mark.parametrize(
    ("message", "at_desk"),
    [
        ("Run 'motionjury\n  render' again", "Run 'Render' again"),
        ("Name its condition (--condition), or", "Name its condition, or"),
        ("Run 'motionjury forget'", "Run 'motionjury forget'"),
    ],
)
def test_messages_name_jobs_instead_of_commands_and_options(message: str, at_desk: str) -> None:
    assert at_the_desk(message) == at_desk


TOUCHING = re.compile(r"[.,;]\{% end(?:if|for) %\}\n\{% if [^%]*%\}(?:\w|\{\{)")
"""A sentence in a block and one in the next: templates trim the newline between them."""


def test_no_sentence_of_a_page_touches_the_next() -> None:
    templates = list(Path(*studyapp.__path__).rglob("*.html"))
    assert len(templates) > 50
    assert [path.name for path in templates if TOUCHING.search(path.read_text("utf-8"))] == []
