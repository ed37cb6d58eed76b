"""Who works at the desk is told what its pages do, not what a command line would."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import pytest

import motion.formats
import studyapp.stimuli
from studyapp.desk.job_kinds import KINDS
from studyapp.desk.wording import TITLES, at_the_desk

STIMULI = Path(*studyapp.stimuli.__path__)
IMPORTING = (
    *Path(*motion.formats.__path__).glob("*.py"),
    *(STIMULI / f"{name}.py" for name in ("recordings", "imported_folder", "stored_speech")),
)
"""What refuses files that are brought in."""

WITHOUT_FIELD = {"--joints"}
"""An option that the page does not have: the message says where to give it."""


def test_commands_are_called_as_the_jobs_are() -> None:
    assert {name: KINDS[name].title for name in TITLES} == TITLES


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("Bring recordings in with 'motionjury import'", "Bring recordings in under 'Bring in'"),
        ("Run 'motionjury\n  render' again", "Run 'Render' again"),
        ("or give --speech to bring in a new take", "or upload its recording too, as a new take"),
        ("6 warnings; --verbose tells 12 notes.", "6 warnings."),
        ("Correct these keys and run the command again", "Correct these keys"),
    ],
)
def test_what_to_do_is_said_of_the_page(said: str, told: str) -> None:
    assert at_the_desk(said) == told


def remedies(path: Path) -> Iterator[str]:
    """Yield what the errors of a module say to do."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.keyword) and node.arg == "remedy":
            words = [part.value for part in ast.walk(node.value) if isinstance(part, ast.Constant)]
            yield "".join(map(str, words))


def test_no_refusal_of_a_file_asks_for_an_option_that_the_page_has_not() -> None:
    said = list(chain(*map(remedies, IMPORTING)))
    asked = {option for each in said for option in re.findall(r"--[a-z-]+", each)}
    still = {option for each in said for option in re.findall(r"--[a-z-]+", at_the_desk(each))}
    assert len(asked) > 5
    assert still == WITHOUT_FIELD
