"""What can be wrong with what participants hear: silence, and loudness that differs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from motion.audio import Audio, read_audio
from motion.errors import InputError
from renderer.loudness import SHORTEST, integrated_loudness
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.study.design.trial import Stimulus
from studyapp.study.finished_videos import finished_video_path

LOUDNESS_TOLERANCE: Final = 1.0
"""LU by which two videos may differ, as EBU R 128 allows live programmes."""

QUIET: Final = -50.0
"""dB below full scale under which nothing is heard beside speech at the common loudness."""

MOST_SILENCE: Final = 0.6
"""Share of a video that may be silent; people pause."""

_BLOCK: Final = 0.1


@dataclass(frozen=True, kw_only=True)
class _Heard:
    """What is heard of one video."""

    name: str
    segment: str
    loudness: float


def sound_findings(material: Material) -> Iterator[Finding]:
    """Say which videos are silent, and which sound louder than others.

    What is rendered of one speech sounds alike, so that one video of it is listened to.
    """
    heard: dict[str, _Heard] = {}
    for name, (stimulus, file) in _sounding(material).items():
        try:
            audio = read_audio(file, sample_rate=None)
        except InputError:
            continue
        loudness = integrated_loudness(audio)
        if loudness is not None:
            heard[name] = _Heard(name=name, segment=stimulus.segment, loudness=loudness)
            yield from _pause_findings(audio, name)
        elif audio.duration >= SHORTEST:
            yield finding("sound-silent", where=name)
    yield from _loudness_findings(heard)


def _sounding(material: Material) -> Mapping[str, tuple[Stimulus, Path]]:
    """Return one video of everything that sounds for itself, under the name it is told by."""
    found: dict[str, tuple[Stimulus, Path]] = {}
    for content, video in material.shown.items():
        shown = content[0]
        if shown.speech is None:
            continue
        name = f"segment {shown.speech}"
        if material.study.is_finished(shown.condition):
            name = material.name_of(finished_video_path(material.folder.videos, shown))
        found.setdefault(name, (shown, video.file))
    return found


def _pause_findings(audio: Audio, name: str) -> Iterator[Finding]:
    silent = silent_share(audio)
    if silent > MOST_SILENCE:
        yield finding("sound-mostly-silent", where=name, share=silent)


def silent_share(audio: Audio) -> float:
    """Return the share of blocks of 100 ms that are quieter than `QUIET`."""
    length = max(1, round(_BLOCK * audio.sample_rate))
    count = max(1, len(audio.samples) // length)
    blocks = audio.samples[: count * length].reshape(count, -1).astype(float)
    power = (blocks**2).mean(axis=1)
    return float((power < 10 ** (QUIET / 10)).mean())


def _loudness_findings(heard: Mapping[str, _Heard]) -> Iterator[Finding]:
    """Say where what is heard in one trial differs, else where segments do."""
    beside: defaultdict[str, list[_Heard]] = defaultdict(list)
    for each in heard.values():
        beside[each.segment].append(each)
    differs = False
    for of_segment in beside.values():
        said = _apart(of_segment)
        if said:
            differs = True
            yield finding("loudness-differs-beside", said, where=of_segment[0].name)
    said = _apart(list(heard.values()))
    if said and not differs:
        yield finding("loudness-differs", said)


def _apart(heard: list[_Heard]) -> str:
    """Say how much louder the loudest is than the softest; empty where that does not matter."""
    if not heard:
        return ""
    softest, loudest = (pick(heard, key=lambda each: each.loudness) for pick in (min, max))
    apart = loudest.loudness - softest.loudness
    if apart <= LOUDNESS_TOLERANCE:
        return ""
    return (
        f"{loudest.name} is {apart:.1f} LU louder than {softest.name} "
        f"({loudest.loudness:.1f} and {softest.loudness:.1f} LUFS)"
    )
