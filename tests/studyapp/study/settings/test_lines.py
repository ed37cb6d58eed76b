"""Errors name the line of a study file in which something is wrong."""

from __future__ import annotations

import re

import pytest

from motion.errors import InputError
from studyapp.study.settings.reading import parse_text
from studyapp.study.template_language import render_template

STUDY = render_template("pairwise.toml", name="lines")
EXTRA = '\n[[questions]]\nname = "extra"\n'


@pytest.mark.parametrize(
    ("before", "after", "line", "said"),
    [
        ("\ntrials = 24", "\ntrials = -24", "trials = -24", "(line {})"),
        ('devices = ["computer", "tablet"]', 'devices = ["watch"]', "devices = ", "(line {})"),
        ('title = "Expression of the emotion"', "title = 3", "title = 3", "(line {})"),
        (
            "sound_check = true",
            'thanks = """\nbreak_every = 3\n[video]\n"""\nsound_check = 7',
            "sound_check = 7",
            "(line {})",
        ),
        # What is missing is named with the table that lacks it.
        ("", EXTRA, "[[questions]]", "(line {})"),
        (
            "[catch]",
            '[catch]\nagianst = "x"',
            "agianst",
            "agianst: unknown key in line {} (did you mean 'against'?)",
        ),
    ],
)
def test_mistakes_are_reported_with_their_line(
    before: str, after: str, line: str, said: str
) -> None:
    text = STUDY.replace(before, after, 1) if before else STUDY + after
    assert text != STUDY
    number = max(number for number, words in enumerate(text.split("\n"), 1) if line in words)
    with pytest.raises(InputError, match=re.escape(said.format(number))):
        parse_text(text, where="study.toml")
