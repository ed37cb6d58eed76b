"""Small studies of all protocols with every kind of question: whole ways for rehearsals."""

import tomllib
from collections.abc import Mapping
from pathlib import Path

from studyapp.study.folder import StudyFolder
from tests.support.studies.finished_study import (
    EVERY_STUDY,
    REASONS,
    Keys,
    group,
    question,
    study_file,
    write_finished_study,
)
from tests.support.studies.form_questions import CLOSING, DEMOGRAPHICS, ELIGIBILITY, SCALE

PERMISSION = """
[[form.consent]]
name = "watched"
text = "May we see what you watch?"
choices = ["yes", "no"]
eligible = ["yes"]
"""
FORMS = tomllib.loads(ELIGIBILITY + PERMISSION + DEMOGRAPHICS + SCALE + CLOSING)["form"]
LANGUAGES = {"ratings": "de", "rankings with ties": "ja"}
"""Studies whose pages are not in English."""

STUDIES: Mapping[str, Keys] = {
    "all pairs": {"protocol": "pairwise"},
    "adaptive pairs": {"protocol": "pairwise", "comparisons": "adaptive"},
    "ratings": {
        "protocol": "rating",
        "sets": [
            group("three", "ours", "theirs", "real", groups=1),
            group("two", "ours", "real", groups=1),
        ],
        "questions": [
            question(
                "labelled",
                "How well does it fit?",
                labels=["not", "hardly", "half", "mostly", "wholly"],
                parts=["three"],
                reasons=REASONS,
            ),
            question("slider", "How well does it go along?", scale="slider"),
            question("opinion", "How good is it?", scale="mean_opinion"),
        ],
    },
    "rankings": {
        "protocol": "ranking",
        "attention": {"trials": 1},
        "blocks": [group("all", "ours", "theirs", trials=3)],
    },
    "rankings with ties": {
        "protocol": "ranking",
        "reference": None,
        "ties": True,
        "attention": {"trials": 1},
        "blocks": [
            group("three", "ours", "theirs", "real", trials=1),
            group("two", "ours", "real", trials=1),
        ],
        "questions": [question("realism", "Which looks most real?", reasons=REASONS)],
    },
    "mismatch": {"protocol": "mismatch"},
}
"""Changes of each study file to the table of finished studies."""


def definition(name: str) -> str:
    """Return the study file of one of `STUDIES`, without pages around the trials."""
    return study_file(**STUDIES[name])


def write_study(folder: Path, name: str, video: Path) -> StudyFolder:
    """Write one of `STUDIES` into `folder`; all its videos show what `video` does."""
    folder.mkdir()
    page = EVERY_STUDY["page"] | {
        "sound_check": True,
        "break_every": 1,
        "language": LANGUAGES.get(name, "en"),
    }
    write_finished_study(folder, video=video, page=page, form=FORMS, **STUDIES[name])
    return StudyFolder(folder)
