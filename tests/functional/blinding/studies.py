"""A study of each protocol, whose videos would give themselves away if their files could."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from studyapp.stimuli.rendering import render
from studyapp.study.folder import StudyFolder
from studyapp.study.media import finished_video_path
from tests.functional.blinding.unlike_videos import write_brought, write_motion, write_speech
from tests.support.in_process_rendering import rendering_in_process
from tests.support.studies.finished_study import Keys, brought, group, question, study_file

PAGE: Final = {"consent": "You agree.", "break_every": 2}
VIDEO: Final = {"size": 64, "frame_rate": 10}
CONDITIONS: Final = ("still", "calm", "lively")
RENDERED: Final[Keys] = {"conditions": {name: {} for name in CONDITIONS}, "attention": None}
BROUGHT: Final[Keys] = {"conditions": brought(*CONDITIONS), "attention": {"trials": 1}}

STUDIES: Final[Mapping[str, Keys]] = {
    "composed": RENDERED
    | {
        "protocol": "pairwise",
        "comparisons": None,
        "layout": None,
        "reference": "calm",
        "participants": None,
        "participants_per_comparison": 40,
        "trials": 4,
        "catch": {"trials": 1, "against": "calm"},
        "questions": [
            question(
                "emotion",
                "The speaker feels {emotion}. In which video do the gestures show it better?",
            )
        ],
    },
    "players": BROUGHT
    | {
        "protocol": "pairwise",
        "reference": "calm",
        "trials": 4,
        "practice": 0,
        "catch": {"trials": 1, "against": "calm", "videos": True},
    },
    "rating": RENDERED
    | {
        "protocol": "rating",
        "catch": {"trials": 1, "against": "lively"},
        "sets": [group("all", *CONDITIONS, groups=4)],
    },
    "ranking": BROUGHT
    | {
        "protocol": "ranking",
        "reference": "lively",
        "catch": {"trials": 1, "against": "calm", "videos": True},
        "blocks": [group("all", "still", "calm", trials=3)],
    },
    "mismatch": RENDERED
    | {"protocol": "mismatch", "realism": 2, "catch": {"trials": 1, "against": "calm"}},
}
"""Changes of each study file to the table of finished studies."""


def write_study(root: Path, name: str) -> StudyFolder:
    """Write one of `STUDIES` into `root`, its videos rendered or brought, and copied."""
    folder = StudyFolder(root)
    root.mkdir(parents=True)
    keys: Keys = {"participants": 40, "video": VIDEO, "page": PAGE} | STUDIES[name]
    folder.definition.write_text(study_file(**keys), encoding="utf-8")
    segments = {segment.name: segment for segment in write_speech(folder.speech)}
    study = folder.study()
    for shown in {
        shown for content in study.contents(tuple(segments.values())) for shown in content
    }:
        segment = segments[shown.segment]
        if study.is_finished(CONDITIONS[0]):
            target = finished_video_path(folder.videos, shown)
            write_brought(target, shown.condition, segment, folder.speech)
        else:
            write_motion(folder.clip(shown.condition, segment.name), shown.condition, segment)
    with rendering_in_process():
        assert render(folder, processes=1).failures == ()
    return folder
