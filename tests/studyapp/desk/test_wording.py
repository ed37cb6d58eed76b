"""Who works at the desk is told what its pages do, not what a command line would."""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path

import pytest

import motion
import studyapp.stimuli
from studyapp.desk.job_kinds import KINDS
from studyapp.desk.wording import TITLES, at_the_desk

STIMULI = Path(*studyapp.stimuli.__path__)
IMPORTING = (
    *Path(*motion.__path__).rglob("*.py"),
    *(STIMULI / f"{name}.py" for name in ("recordings", "imported_folder", "stored_speech")),
)
"""What refuses files that are brought in."""

REMEDY = re.compile(r"remedy=(.*?)(?:,\n|\n? *\))", re.DOTALL)
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


def test_no_refusal_of_a_file_asks_for_an_option_that_the_page_has_not() -> None:
    remedies = list(chain(*(REMEDY.findall(path.read_text("utf-8")) for path in IMPORTING)))
    assert len(remedies) > 50
    asked = {
        option
        for remedy in remedies
        for option in re.findall(r"--[a-z-]+", at_the_desk(re.sub(r'"\s+f?"', "", remedy)))
    }
    assert asked == WITHOUT_FIELD
