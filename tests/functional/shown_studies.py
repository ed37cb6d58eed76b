"""Studies in which every page for participants occurs."""

import shutil
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from studyapp.study.study_file import read_texts
from tests.support.studies.finished_study import (
    REASONS,
    Keys,
    brought,
    group,
    question,
    write_finished_study,
)
from tests.support.studies.form_questions import CLOSING, CONSENT, DEMOGRAPHICS, ELIGIBILITY, SCALE
from tests.support.studies.redefining import redefine
from tests.support.studies.tiny_study import BACKGROUND, FRAME_RATE, write_tiny_study, write_video

SIZE: Final = 360

PAGE: Final = {
    "organisation": "Institute of Gestures",
    "contact": "gestures-and-speech@linguistics.university.example.org",
    "minutes": 10,
    "payment": "2.50 EUR",
    "consent": """
You will watch short videos of an animated speaker and say what you think of them. We store your \
answers, when you gave them and how much of each video was played; nothing that names you.

Taking part is voluntary: you can stop at any time without giving a reason.""",
}

MORE_FORMS: Final = """
[[form.demographics]]
name = "gender"
text = "Which gender are you?"
choices = ["female", "male", "another", "I would rather not say"]

[[form.comprehension]]
name = "judged"
text = "What are you to judge?"
choices = ["how the speaker moves", "what the speaker looks like"]
eligible = ["how the speaker moves"]
"""
FORMS: Final = tomllib.loads(ELIGIBILITY + CONSENT + DEMOGRAPHICS + SCALE + MORE_FORMS + CLOSING)[
    "form"
]

RATED: Final = read_texts("rating")["questions"]
RANKED: Final = [question(q["name"], q["text"]) for q in read_texts("ranking")["questions"]]
THREE: Final = ("ours", "theirs", "real")
FOUR: Final = ("ours", "theirs", "calm", "lively")
FIVE: Final = (*FOUR, "still")

STUDIES: Final[Mapping[str, Keys]] = {
    "players": {
        "protocol": "pairwise",
        "trials": 2,
        "catch": {"trials": 0},
        "attention": None,
        "questions": [
            question(
                "synchronisation",
                "In which video do the gestures fit the rhythm of the speech better?",
                reasons=REASONS,
            ),
            question(
                "emotion", "In which video do the gestures show better what the speaker feels?"
            ),
        ],
        "form": FORMS,
        "page": PAGE | {"sound_check": True, "break_every": 1},
    },
    "labels": {
        "protocol": "rating",
        "attention": None,
        "conditions": brought(*FOUR),
        "sets": [group("all", *FOUR, groups=1), group("fewer", *FOUR[:3], groups=1)],
        "questions": [
            *(question(each["name"], each["text"], labels=each["labels"]) for each in RATED),
            question("quality", "How good is it?", scale="mean_opinion", reasons=REASONS),
        ],
    },
    "sliders": {
        "protocol": "rating",
        "sets": [group("all", *THREE, groups=1)],
        "questions": [
            question("quality", "How human does the motion look?", scale="slider"),
            question(
                "fit", "How well does the motion fit the speech?", scale="slider", reasons=REASONS
            ),
        ],
    },
    "ranking": {
        "protocol": "ranking",
        "conditions": brought(*FIVE, "real"),
        "blocks": [group("five", *FIVE, trials=1), group("three", *FIVE[:3], trials=1)],
        "questions": RANKED,
    },
    "ties": {
        "protocol": "ranking",
        "reference": None,
        "ties": True,
        "attention": {"trials": 1},
        "conditions": brought(*FOUR),
        "blocks": [group("four", *FOUR, trials=1)],
        "questions": RANKED,
    },
    "mismatch": {"protocol": "mismatch", "fit": 1, "attention": None},
}
"""Changes of each study file to the table of finished studies; `composed` is the tiny study."""

NAMES: Final = ("composed", *STUDIES)


def write_shown_study(folder: Path, name: str, *, participants: int = 50) -> None:
    """Write one of the studies `NAMES` into `folder`, ready to serve."""
    folder.mkdir(parents=True)
    if name == "composed":
        write_tiny_study(folder, seconds=1.0)
        redefine(folder, ("trials = 4", "trials = 1"))
        return
    figure = folder / "figure.mp4"
    write_video(figure, map(_figure, range(FRAME_RATE)), seconds=1.0)
    keys: Keys = {"participants": participants, "page": PAGE} | STUDIES[name]
    write_finished_study(folder, video=figure, **keys)


def write_way(folder: Path, tiny_study: Path, *, trials: int, page: str = "") -> None:
    """Write the tiny study into `folder`, with everything around its trials."""
    shutil.copytree(tiny_study, folder)
    redefine(
        folder,
        ("[page]\n", f"[page]\nsound_check = true\n{page}"),
        ("trials = 4\npractice = 1", f"trials = {trials}\npractice = 0"),
        added=ELIGIBILITY + CONSENT + DEMOGRAPHICS + SCALE + CLOSING,
    )


def _figure(index: int) -> NDArray[np.uint8]:
    """Return a picture of a figure that waves, on the background of rendered videos."""
    picture = Image.new("RGB", (SIZE, SIZE), (BACKGROUND,) * 3)
    draw = ImageDraw.Draw(picture)
    swing = 40 * np.sin(index / 2)
    draw.ellipse((135, 50, 225, 150), fill=(196, 150, 122))
    draw.rounded_rectangle((115, 155, 245, 380), radius=30, fill=(70, 90, 130))
    draw.line((125, 180, 75, 260, 60 + swing, 200 - swing), fill=(70, 90, 130), width=30)
    draw.line((235, 180, 290, 265, 250 - swing, 290), fill=(70, 90, 130), width=30)
    return np.asarray(picture)
