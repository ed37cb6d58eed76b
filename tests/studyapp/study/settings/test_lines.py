"""In which line of a study file something is wrong."""

from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.study.settings.reading import parse_text
from studyapp.study.template_language import render_template

STUDY = render_template("pairwise.toml", name="lines")


def line_with(text: str, words: str) -> int:
    """Return the number of the last line that holds `words`."""
    return max(number for number, line in enumerate(text.split("\n"), 1) if words in line)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("\ntrials = 24", "\ntrials = -24"),
        ('devices = ["computer", "tablet"]', 'devices = ["watch"]'),
        ('title = "Expression of the emotion"', "title = 3"),
        ("sound_check = true", 'thanks = """\nbreak_every = 3\n[video]\n"""\nsound_check = 7'),
    ],
)
def test_every_wrong_value_is_told_with_its_line(before: str, after: str) -> None:
    text = STUDY.replace(before, after, 1)
    assert text != STUDY
    line = line_with(text, after.split("\n")[-1])
    with pytest.raises(InputError, match=rf"line {line}\)"):
        parse_text(text, where="study.toml")


def test_what_is_missing_is_told_with_the_table_that_lacks_it() -> None:
    text = STUDY + '\n[[questions]]\nname = "extra"\n'
    with pytest.raises(InputError, match=rf"line {line_with(text, '[[questions]]')}\)"):
        parse_text(text, where="study.toml")
