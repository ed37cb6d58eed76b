"""What can be wrong with finished videos: whether they are there, whole, and encoded alike."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Final

from motion.segment import Segment
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import Material
from studyapp.session.served_study import described
from studyapp.stimuli.media_probe import (
    DURATION_TOLERANCE,
    Flaw,
    VideoFormat,
    flaw_of,
    format_of,
)
from studyapp.study.design.trial import Content
from studyapp.study.finished_videos import finished_video_path, similar_file

_DIFFERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "size": "picture-size-differs",
        "frame_rate": "frame-rate-differs",
        "picture": "picture-format-differs",
        "sound": "sound-format-differs",
    }
)

SMALLEST: Final = 360
"""Pixels of the shorter side below which hands of an upper body are some ten pixels wide."""

SLOWEST: Final = 24
"""Frames per second of films; below, motion is seen as single pictures."""

ENCODE: Final = (
    "Encode all finished videos alike, as with 'ffmpeg -i IN.mp4 -r {rate:g} -s {width}x{height} "
    "-c:v libx264 -crf 18 -bf 0 -sc_threshold 0 -pix_fmt yuv420p -c:a aac -ar 48000 -ac 1 OUT.mp4'"
)


def encode_like(example: VideoFormat) -> str:
    """Return how all videos can be encoded as `example` is."""
    return ENCODE.format(rate=example.frame_rate, width=example.width, height=example.height)


def finished_video_findings(material: Material) -> Iterator[Finding]:
    """Yield what is missing or broken of the videos that were brought, and how they differ."""
    for content in material.brought.values():
        yield from _original_findings(material, content, material.by_name[content[0].segment])
    yield from _format_findings(material)
    yield from _look_findings(material)


def flaw_finding(flaw: Flaw, name: str, remedy: str) -> Finding:
    """Return what is wrong with the video `name`."""
    return finding(flaw.kind, f"{name} {flaw.what}", where=name, remedy=remedy)


def _original_findings(material: Material, content: Content, segment: Segment) -> Iterator[Finding]:
    (shown,) = content
    file = finished_video_path(material.folder.videos, shown)
    name = material.name_of(file)
    if not file.is_file():
        similar = similar_file(file, material.brought.keys())
        yield finding(
            "video-missing",
            f"the video of {described(content)} is missing",
            where=name,
            remedy=f"Bring it as {file}, or set allow_gaps = true in study.toml to leave the "
            "segment out"
            if similar is None
            else f"Rename {material.name_of(similar)} if that is the video, or bring it as {file}",
        )
        return
    flaw = flaw_of(file, segment.duration, sound=shown.speech is not None)
    if flaw is not None:
        yield flaw_finding(
            flaw, name, f"Bring it anew; lengths may differ by {DURATION_TOLERANCE} s"
        )


def _format_findings(material: Material) -> Iterator[Finding]:
    """Say where videos are encoded so that a browser may not play them, or can tell them apart."""
    study = material.study
    formats: defaultdict[str, dict[str, VideoFormat]] = defaultdict(dict)
    for file, content in material.brought.items():
        found = format_of(file)
        if found is not None:
            formats[content[0].segment][material.name_of(file)] = found
    drawn = any(not study.is_finished(name) for name in study.conditions)
    wanted = VideoFormat.rendered(study.video.size, study.video.frame_rate) if drawn else None
    for of_segment in formats.values():
        remedy = encode_like(wanted or next(iter(of_segment.values())))
        for name, found in of_segment.items():
            if (why := found.unplayable) is not None:
                yield finding("video-unplayable", f"{name} {why}", where=name, remedy=remedy)
        named = {**of_segment, **({"a rendered video": wanted} if wanted else {})}
        for attribute, words in VideoFormat.WORDS.items():
            of_value: dict[object, str] = {}
            for name, found in named.items():
                of_value.setdefault(getattr(found, attribute), name)
            if len(of_value) > 1:
                told = ", ".join(f"{value} in {name}" for value, name in of_value.items())
                yield finding(
                    _DIFFERS[attribute],
                    f"{words} differs, which tells videos apart: {told}",
                    where=next(iter(of_segment)),
                    remedy=remedy,
                )


def _look_findings(material: Material) -> Iterator[Finding]:
    """Say where videos are too small or too slow to be judged by."""
    video = material.study.video
    smallest, slowest, where = float(video.size), float(video.frame_rate), "video"
    if material.study.only_finished:
        formats = {file: format_of(file) for file in material.brought}
        known = {file: found for file, found in formats.items() if found is not None}
        if not known:
            return
        small = min(known, key=lambda file: min(known[file].width, known[file].height))
        smallest = min(known[small].width, known[small].height)
        slowest = min(found.frame_rate for found in known.values())
        where = material.name_of(small)
    if smallest < SMALLEST:
        yield finding("picture-small", where=where, pixels=smallest)
    if slowest < SLOWEST:
        yield finding("frame-rate-low", where=where, rate=slowest)
