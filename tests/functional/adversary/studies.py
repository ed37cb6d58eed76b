"""A study of each protocol, whose videos would give themselves away if their files could."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from motion.files import digest
from motion.segment import Segment
from studyapp.stimuli.rendering import equalise_sizes
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.design.trial import Content
from studyapp.study.finished_videos import finished_video_path
from studyapp.study.folder import StudyFolder
from studyapp.study.media import ClipVideo, PairVideo, Stimuli, write_stimuli
from tests.functional.adversary import unlike_videos as videos
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
"""What each study file says otherwise than the table of finished studies."""


def instructs(name: str) -> bool:
    """Tell whether pages of the study's attention checks say what they are."""
    return bool(STUDIES[name]["attention"])


def write_study(root: Path, name: str) -> StudyFolder:
    """Write one of `STUDIES` into `root`, ready to serve, its videos made and copied."""
    folder = StudyFolder(root)
    root.mkdir(parents=True)
    keys: Keys = {"participants": 40, "video": VIDEO, "page": PAGE} | STUDIES[name]
    folder.definition.write_text(study_file(**keys), encoding="utf-8")
    segments = {segment.name: segment for segment in videos.write_speech(folder.speech)}
    study = folder.study()
    contents = list(study.contents(tuple(segments.values())))
    if study.is_finished(CONDITIONS[0]):
        for (shown,) in contents:
            target = finished_video_path(folder.videos, shown)
            if not target.exists():
                videos.write_brought(
                    target, shown.condition, segments[shown.segment], folder.speech
                )
        write_stimuli(folder.stimuli, Stimuli())
    else:
        write_stimuli(folder.stimuli, _rendered(folder, segments, contents))
    copy_videos(folder)
    equalise_sizes(folder)
    return folder


def _rendered(
    folder: StudyFolder, segments: dict[str, Segment], contents: Sequence[Content]
) -> Stimuli:
    """Write what `contents` need as rendering does, and return its record."""
    clips: dict[str, ClipVideo] = {}
    pairs: dict[str, PairVideo] = {}
    for content in contents:
        segment = segments[content[0].segment]
        if len(content) > 1:
            pair = _pair(folder, segment, content)
            pairs[pair.file] = pair
            continue
        (shown,) = content
        made = _clip(folder, segment, shown.condition)
        clips[made.file] = made
        if shown.speech not in (None, segment.name):
            made = _dub(folder, made, segment, segments[str(shown.speech)])
            clips[made.file] = made
    return Stimuli(clips=tuple(clips.values()), pairs=tuple(pairs.values()))


def _pair(folder: StudyFolder, segment: Segment, content: Content) -> PairVideo:
    left, right = (shown.condition for shown in content)
    sides = [folder.videos / ".frames" / f"{side}-{segment.name}.mkv" for side in (left, right)]
    for side, frames in zip((left, right), sides, strict=True):
        if not frames.exists():
            videos.write_frames(frames, side, segment)
    file = f"videos/pairs/{digest(segment.name, left, right)}.mp4"
    videos.write_composed(folder.root / file, sides, segment, folder.speech)
    return PairVideo(
        segment=segment.name,
        left=left,
        right=right,
        file=file,
        duration=segment.duration,
        key=file,
    )


def _clip(folder: StudyFolder, segment: Segment, condition: str) -> ClipVideo:
    file = f"videos/clips/{condition}/{segment.name}.mp4"
    if not (folder.root / file).exists():
        videos.write_clip(folder.root / file, condition, segment, folder.speech)
    return ClipVideo(
        segment=segment.name,
        condition=condition,
        file=file,
        duration=segment.duration,
        key=file,
    )


def _dub(folder: StudyFolder, clip: ClipVideo, segment: Segment, other: Segment) -> ClipVideo:
    file = clip.file.replace(".mp4", f"@{other.name}.mp4")
    videos.write_dub(folder.root / file, folder.root / clip.file, segment, other, folder.speech)
    return clip.model_copy(update={"file": file, "key": file, "speech": other.name})
