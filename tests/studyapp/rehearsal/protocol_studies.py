"""Small studies of all protocols that ask all there is to ask: whole ways for rehearsals."""

from __future__ import annotations

from pathlib import Path

from studyapp.study.folder import StudyFolder
from tests.support.studies.finished_study import COMMON, PROTOCOLS, write_study_of_one_video

AROUND = "sound_check = true\nbreak_every = 1\n"
"""Keys of `[page]`: the pages around the trials."""

ABOUT = """
[[form.eligibility]]
name = "adult"
text = "Are you 18 or older?"
choices = ["yes", "no"]
eligible = ["yes"]

[[form.consent]]
name = "watched"
text = "May we see what you watch?"
choices = ["yes", "no"]
eligible = ["yes"]

[[form.demographics]]
name = "age"
text = "How old are you?"
kind = "number"
low = 18

[[form.demographics]]
name = "work"
text = "What do you work on?"
kind = "text"
required = false

[[form.closing]]
name = "ease"
text = "How easy was it?"
kind = "scale"
low = 1
high = 7
choices = ["hard", "easy"]
"""

LANGUAGES = {"ratings": "de", "rankings with ties": "ja"}
"""Studies whose pages are not in English."""

STUDIES: dict[str, str] = {
    "all pairs": PROTOCOLS["pairwise"],
    "adaptive pairs": PROTOCOLS["pairwise"].replace('"all_pairs"', '"adaptive"'),
    "ratings": """
protocol = "rating"
participants = 3
attention = { trials = 1 }

[[sets]]
name = "three"
conditions = ["ours", "theirs", "real"]
groups = 1

[[sets]]
name = "two"
conditions = ["ours", "real"]
groups = 1

[[questions]]
name = "labelled"
title = "Labelled"
text = "How well does it fit?"
labels = ["not", "hardly", "half", "mostly", "wholly"]
parts = ["three"]
reasons = [{ name = "hands", text = "the hands" }, { name = "face", text = "the face" }]

[[questions]]
name = "slider"
title = "Slider"
text = "How well does it go along?"
scale = "slider"

[[questions]]
name = "opinion"
title = "Opinion"
text = "How good is it?"
scale = "mean_opinion"
""",
    "rankings": PROTOCOLS["ranking"]
    .replace("participants = 3", "participants = 3\nattention = { trials = 1 }")
    .replace("trials = 2", "trials = 3"),
    "rankings with ties": """
protocol = "ranking"
participants = 3
ties = true
attention = { trials = 1 }

[[blocks]]
name = "three"
conditions = ["ours", "theirs", "real"]
trials = 1

[[blocks]]
name = "two"
conditions = ["ours", "real"]
trials = 1

[[questions]]
name = "realism"
title = "Realism"
text = "Which looks most real?"
reasons = [{ name = "hands", text = "the hands" }]
""",
    "mismatch": PROTOCOLS["mismatch"],
}
"""What the study file of each says beside what all say."""


def definition(name: str, *, around: bool = True) -> str:
    """Return the study file of one of `STUDIES`, with or without pages around the trials."""
    keys, tables = STUDIES[name].split("\n\n", 1)
    if not around:
        return f"{keys}\n{COMMON}\n{tables}"
    language = f'language = "{LANGUAGES.get(name, "en")}"\n'
    return f"{keys}\n{COMMON}{AROUND}{language}\n{tables}{ABOUT}"


def write_study(folder: Path, name: str, video: Path) -> StudyFolder:
    """Write one of `STUDIES` into `folder`; all its videos show what `video` does."""
    folder.mkdir()
    write_study_of_one_video(folder, definition(name), video)
    return StudyFolder(folder)
