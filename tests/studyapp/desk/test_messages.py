"""Messages of commands are adapted to the desk, which has no options."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import motion.formats
import studyapp
import studyapp.stimuli
from studyapp.desk.page import at_the_desk

STIMULI = Path(*studyapp.stimuli.__path__)
IMPORTING = (
    *Path(*motion.formats.__path__).glob("*.py"),
    *(STIMULI / f"{name}.py" for name in ("recordings", "imported_folder", "stored_speech")),
)
"""Modules that refuse files that are brought in."""

WITHOUT_FIELD = {"--joints"}
"""An option that the page does not have: its message sends one to the command line."""


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


def test_no_refusal_mentions_an_option_that_the_page_lacks() -> None:
    constants = (
        node.value
        for path in IMPORTING
        for keyword in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(keyword, ast.keyword) and keyword.arg == "remedy"
        for node in ast.walk(keyword.value)
        if isinstance(node, ast.Constant)
    )
    remedies = " ".join(map(str, constants))

    assert len(set(re.findall(r"--[a-z-]+", remedies))) > 5
    assert set(re.findall(r"--[a-z-]+", at_the_desk(remedies))) == WITHOUT_FIELD


TOUCHING = re.compile(r"[.,;]\{% end(?:if|for) %\}\n\{% if [^%]*%\}(?:\w|\{\{)")
"""A sentence in a block and one in the next: templates trim the newline between them."""


def test_no_sentence_of_a_page_touches_the_next() -> None:
    templates = list(Path(*studyapp.__path__).rglob("*.html"))
    assert len(templates) > 50
    assert [path.name for path in templates if TOUCHING.search(path.read_text("utf-8"))] == []
