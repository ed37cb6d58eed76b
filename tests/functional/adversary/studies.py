"""A study of each protocol, whose videos would give themselves away if their files could."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from motion.files import digest
from motion.segment import Segment
from studyapp.stimuli.rendering import hide_sizes
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.design.trial import Content
from studyapp.study.finished_videos import finished_video_path
from studyapp.study.folder import StudyFolder
from studyapp.study.media import ClipVideo, PairVideo, Stimuli, write_stimuli
from tests.functional.adversary import unlike_videos as videos

QUESTION: Final = """
[[questions]]
name = "better"
title = "Better"
text = "Which is better?"
"""

RATED: Final = """
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
"""

PAGE: Final = """
[video]
size = 64
frame_rate = 10

[page]
consent = "You agree."
break_every = 2
"""


@dataclass(frozen=True, kw_only=True)
class Declared:
    """A study as its file says, and where its videos come from.

    Attributes
    ----------
    brought : bool
        Whether they are brought finished.
    instructs : bool
        Whether pages of attention checks say what they are.
    """

    text: str
    brought: bool = False
    instructs: bool = False


def _conditions(*, brought: bool) -> str:
    names = ("still", "calm", "lively")
    return "".join(f"[conditions.{n}]\n{'videos = true' * brought}\n" for n in names)


STUDIES: Final = {
    "composed": Declared(
        text=f"""
protocol = "pairwise"
reference = "calm"
participants_per_comparison = 40
trials = 4
practice = 1
catch = {{ trials = 1, against = "calm" }}
{_conditions(brought=False)}
[[questions]]
name = "emotion"
title = "Emotion"
text = "The speaker feels {{emotion}}. In which video do the gestures show it better?"
""",
    ),
    "players": Declared(
        text=f"""
protocol = "pairwise"
comparisons = "all_pairs"
layout = "players"
reference = "calm"
participants = 40
trials = 4
practice = 0
catch = {{ trials = 1, against = "calm", videos = true }}
attention = {{ trials = 1 }}
{_conditions(brought=True)}{QUESTION}""",
        brought=True,
        instructs=True,
    ),
    "rating": Declared(
        text=f"""
protocol = "rating"
participants = 40
catch = {{ trials = 1, against = "lively" }}
{_conditions(brought=False)}
[[sets]]
name = "all"
conditions = ["still", "calm", "lively"]
groups = 4
{RATED}""",
    ),
    "ranking": Declared(
        text=f"""
protocol = "ranking"
participants = 40
reference = "lively"
catch = {{ trials = 1, against = "calm", videos = true }}
attention = {{ trials = 1 }}
{_conditions(brought=True)}
[[blocks]]
name = "all"
conditions = ["still", "calm"]
trials = 3
{QUESTION}""",
        brought=True,
        instructs=True,
    ),
    "mismatch": Declared(
        text=f"""
protocol = "mismatch"
participants = 40
fit = 2
realism = 2
catch = {{ trials = 1, against = "calm" }}
{_conditions(brought=False)}{QUESTION}""",
    ),
}


def write_study(root: Path, name: str) -> StudyFolder:
    """Write one of `STUDIES` into `root`, ready to serve, its videos made and copied."""
    declared = STUDIES[name]
    folder = StudyFolder(root)
    head = f'name = "{name}"\ntitle = "Gestures"\n'
    root.mkdir(parents=True)
    folder.definition.write_text(f"{head}{declared.text}{PAGE}", encoding="utf-8")
    segments = {segment.name: segment for segment in videos.write_speech(folder.speech)}
    study = folder.study()
    contents = list(study.contents(tuple(segments.values())))
    if declared.brought:
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
    hide_sizes(folder)
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
