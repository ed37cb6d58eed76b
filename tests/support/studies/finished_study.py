"""Small studies of every protocol, of finished videos alone: no speech, motion or rendering.

`PROTOCOLS` is the one table: whoever needs other pages or questions changes keys of it.
"""

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit

from studyapp.stimuli.rendering import equalise_sizes
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.folder import StudyFolder
from studyapp.study.media import finished_video_path
from tests.support.studies.tiny_study import write_pair_video

Keys = dict[str, Any]
"""Keys of a study file, or of one of its tables."""

SEGMENTS = ("one", "two", "three")
REASONS = [{"name": "hands", "text": "the hands"}, {"name": "face", "text": "the face"}]


def question(name: str, text: str, **keys: Any) -> Keys:
    return {"name": name, "title": name.replace("_", " ").capitalize(), "text": text, **keys}


def brought(*conditions: str) -> Keys:
    """Return conditions that have finished videos."""
    return {condition: {"videos": True} for condition in conditions}


def group(name: str, *conditions: str, **keys: Any) -> Keys:
    """Return a set of ratings or a block of rankings."""
    return {"name": name, "conditions": list(conditions), **keys}


EVERY_STUDY: Keys = {
    "name": "finished",
    "title": "Finished videos",
    "participants": 3,
    "conditions": brought("ours", "theirs", "real"),
    "page": {"consent": "You agree."},
}
PROTOCOLS: Mapping[str, Keys] = {
    "pairwise": {
        "comparisons": "all_pairs",
        "layout": "players",
        "reference": "ours",
        "trials": 3,
        "practice": 1,
        "catch": {"trials": 1, "against": "real", "videos": True},
        "attention": {"trials": 1},
        "questions": [question("fit", "Which fits better?")],
    },
    "rating": {
        "attention": {"trials": 1},
        "sets": [group("all", "ours", "theirs", "real", groups=2)],
        "questions": [
            question("quality", "How good is it?", scale="mean_opinion"),
            question("synchrony", "How well does it go along?", scale="slider", reasons=REASONS),
        ],
    },
    "ranking": {
        "reference": "real",
        "blocks": [group("all", "ours", "theirs", trials=2)],
        "questions": [question("realism", "Which looks most real?")],
    },
    "mismatch": {
        "fit": 2,
        "realism": 1,
        "attention": {"trials": 1},
        "questions": [question("better", "Which is better?")],
    },
}


def study_file(protocol: str, **changes: Any) -> str:
    """Return the study file of a protocol; keys that `changes` names as None are left out."""
    keys = {"protocol": protocol, **EVERY_STUDY, **PROTOCOLS[protocol], **changes}
    stated = {name: value for name, value in keys.items() if value is not None}
    # What stands below the heading of a table belongs to the table.
    return tomlkit.dumps(dict(sorted(stated.items(), key=lambda item: _is_table(item[1]))))


def _is_table(value: object) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and isinstance(value[0], dict))


def write_finished_study(folder: Path, protocol: str, video: Path, **changes: Any) -> None:
    """Write a study of `protocol` into `folder`, ready to serve; all show what `video` does."""
    (folder / "study.toml").write_text(study_file(protocol, **changes), encoding="utf-8")
    files = StudyFolder(folder)
    study = files.study()
    conditions = [*study.conditions, *([study.catch.condition] if study.catch.trials else [])]
    for condition in conditions:
        for segment in SEGMENTS:
            _copy(video, folder / "videos" / condition / f"{segment}.mp4")
    for shown, *_ in study.contents(files.segments_of(study)):
        _copy(video, finished_video_path(files.videos, shown))
    copy_videos(files)
    equalise_sizes(files)


def write_short_video(path: Path, *, seconds: float = 2.0) -> None:
    """Write the video that all stimuli of these studies are copies of."""
    write_pair_video(path, shade=60, seconds=seconds)


def _copy(video: Path, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(video, path)
