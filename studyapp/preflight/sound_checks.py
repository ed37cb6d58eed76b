"""Whether videos are silent, or differ in loudness."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from motion.audio import read_audio
from motion.errors import InputError
from renderer.loudness import SHORTEST, integrated_loudness
from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import Material
from studyapp.study.design.trial import Stimulus
from studyapp.study.media import finished_video_path

LOUDNESS_TOLERANCE: Final = 1.0
"""LU by which two videos may differ, as EBU R 128 allows live programmes."""


def sound_findings(material: Material) -> Iterator[Finding]:
    """Yield videos that are silent, and those that are louder than others.

    Of the videos rendered with the same speech, one is measured.
    """
    loudness: defaultdict[str, dict[str, float]] = defaultdict(dict)
    for name, (stimulus, file) in _distinct_sounds(material).items():
        try:
            audio = read_audio(file, sample_rate=None)
        except InputError:
            continue  # reported by the checks of videos
        lufs = integrated_loudness(audio)
        if lufs is not None:
            loudness[stimulus.segment][name] = lufs
        elif audio.duration >= SHORTEST:
            yield make_finding("sound-silent", where=name)
    yield from _loudness_findings(loudness)


def _distinct_sounds(material: Material) -> Mapping[str, tuple[Stimulus, Path]]:
    """Return, by display name, one video of each speech and every finished video."""
    sounds: dict[str, tuple[Stimulus, Path]] = {}
    for content, video in material.shown.items():
        stimulus = content[0]
        if stimulus.speech is None:
            continue
        name = f"segment {stimulus.speech}"
        if material.study.is_finished(stimulus.condition):
            name = material.display_path(finished_video_path(material.folder.videos, stimulus))
        sounds.setdefault(name, (stimulus, video.file))
    return sounds


def _loudness_findings(by_segment: Mapping[str, Mapping[str, float]]) -> Iterator[Finding]:
    """Yield differences within a segment or, if there are none, between segments.

    Parameters
    ----------
    by_segment : mapping of str to mapping of str to float
        The loudness of each video in LUFS, by segment and display name.
    """
    differs = False
    for videos in by_segment.values():
        if difference := _describe_difference(videos):
            differs = True
            yield make_finding("loudness-differs-beside", difference, where=next(iter(videos)))
    everything = {name: lufs for videos in by_segment.values() for name, lufs in videos.items()}
    if not differs and (difference := _describe_difference(everything)):
        yield make_finding("loudness-differs", difference)


def _describe_difference(videos: Mapping[str, float]) -> str:
    """Return how much louder the loudest video is than the softest; empty within tolerance."""
    if not videos:
        return ""
    softest, loudest = min(videos, key=videos.__getitem__), max(videos, key=videos.__getitem__)
    difference = videos[loudest] - videos[softest]
    if difference <= LOUDNESS_TOLERANCE:
        return ""
    return (
        f"{loudest} is {difference:.1f} LU louder than {softest} "
        f"({videos[loudest]:.1f} and {videos[softest]:.1f} LUFS)"
    )
