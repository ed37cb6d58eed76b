"""Small studies of every protocol, of finished videos alone: no speech, motion or rendering."""

from __future__ import annotations

import shutil
from pathlib import Path

from studyapp.stimuli.rendering import hide_sizes
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.finished_videos import finished_video_path
from studyapp.study.folder import StudyFolder
from tests.support.studies.tiny_study import write_pair_video

SEGMENTS = ("one", "two", "three")

COMMON = """\
name = "finished"
title = "Finished videos"

[conditions.ours]
videos = true
[conditions.theirs]
videos = true
[conditions.real]
videos = true

[page]
consent = "You agree."
"""

PROTOCOLS = {
    "pairwise": """
protocol = "pairwise"
comparisons = "all_pairs"
layout = "players"
reference = "ours"
participants = 3
trials = 3
practice = 1
catch = { trials = 1, against = "real", videos = true }
attention = { trials = 1 }

[[questions]]
name = "fit"
title = "Fit"
text = "Which fits better?"
""",
    "rating": """
protocol = "rating"
participants = 3
attention = { trials = 1 }

[[sets]]
name = "all"
conditions = ["ours", "theirs", "real"]
groups = 2

[[questions]]
name = "quality"
title = "Quality"
text = "How good is it?"
scale = "mean_opinion"

[[questions]]
name = "synchrony"
title = "Synchrony"
text = "How well does it go along?"
scale = "slider"
reasons = [{ name = "hands", text = "the hands" }, { name = "face", text = "the face" }]
""",
    "ranking": """
protocol = "ranking"
participants = 3
reference = "real"

[[blocks]]
name = "all"
conditions = ["ours", "theirs"]
trials = 2

[[questions]]
name = "realism"
title = "Realism"
text = "Which looks most real?"
""",
    "mismatch": """
protocol = "mismatch"
participants = 3
fit = 2
realism = 1
attention = { trials = 1 }

[[questions]]
name = "better"
title = "Better"
text = "Which is better?"
""",
}
"""What the study file of each protocol says beside what all say."""


def write_finished_study(folder: Path, protocol: str, video: Path) -> None:
    """Write a study of `protocol` into `folder`, ready to serve; all show what `video` does."""
    keys, tables = PROTOCOLS[protocol].split("\n\n", 1)
    write_study_of_one_video(folder, f"{keys}\n{COMMON}\n{tables}", video)


def write_study_of_one_video(folder: Path, definition: str, video: Path) -> None:
    """Write the study that `definition` declares, of finished videos that all are `video`."""
    (folder / "study.toml").write_text(definition, encoding="utf-8")
    files = StudyFolder(folder)
    study = files.study()
    conditions = [*study.conditions, *([study.catch.condition] if study.catch.trials else [])]
    for condition in conditions:
        for segment in SEGMENTS:
            _copy(video, folder / "videos" / condition / f"{segment}.mp4")
    for shown, *_ in study.contents(tuple(files.segments_of(study))):
        _copy(video, finished_video_path(files.videos, shown))
    copy_videos(files)
    hide_sizes(files)


def write_short_video(path: Path, *, seconds: float = 2.0) -> None:
    """Write the video that all stimuli of these studies are copies of."""
    write_pair_video(path, shade=60, seconds=seconds)


def _copy(video: Path, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(video, path)
