"""Whether finished videos exist, are intact, and are encoded alike."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import Material
from studyapp.session.served_study import describe_content
from studyapp.stimuli.media_probe import (
    DURATION_TOLERANCE,
    Flaw,
    VideoFormat,
    flaw_of,
    format_of,
)
from studyapp.study.design.trial import Content
from studyapp.study.finished_videos import similar_file

_DIFFERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "size": "picture-size-differs",
        "frame_rate": "frame-rate-differs",
        "picture": "picture-format-differs",
        "sound": "sound-format-differs",
    }
)

LEAST_PIXELS: Final = 360
"""Of the shorter side: below, the hands of an upper body are about ten pixels wide."""

LEAST_FRAME_RATE: Final = 24
"""As in films; below, motion is seen as single pictures."""

ENCODE: Final = (
    "Encode all finished videos alike, as with 'ffmpeg -i IN.mp4 -r {rate:g} -s {width}x{height} "
    "-c:v libx264 -crf 18 -bf 0 -sc_threshold 0 -pix_fmt yuv420p -c:a aac -ar 48000 -ac 1 OUT.mp4'"
)


def encode_like(example: VideoFormat) -> str:
    """Return the remedy of encoding all videos as `example` is."""
    return ENCODE.format(rate=example.frame_rate, width=example.width, height=example.height)


def finished_video_findings(material: Material) -> Iterator[Finding]:
    """Yield finished videos that are missing or damaged, and how they differ."""
    for file, content in material.finished.items():
        yield from _file_findings(material, file, content)
    formats = {
        file: video_format
        for file in material.finished
        if (video_format := format_of(file)) is not None
    }
    yield from _format_findings(material, formats)
    yield from _resolution_findings(material, formats)


def flaw_finding(flaw: Flaw, name: str, remedy: str) -> Finding:
    """Return the finding of a flaw in the video `name`."""
    return make_finding(flaw.kind, f"{name} {flaw.what}", where=name, remedy=remedy)


def _file_findings(material: Material, file: Path, content: Content) -> Iterator[Finding]:
    (stimulus,) = content
    name = material.display_path(file)
    if not file.is_file():
        similar = similar_file(file, material.finished.keys())
        remedy = f"Save it as {file}, or set allow_gaps = true in study.toml to omit the segment"
        if similar is not None:
            other = material.display_path(similar)
            remedy = f"Rename {other} if that is the video, or save it as {file}"
        yield make_finding(
            "video-missing",
            f"the video of {describe_content(content)} is missing",
            where=name,
            remedy=remedy,
        )
        return
    segment = material.segments_by_name[stimulus.segment]
    flaw = flaw_of(file, segment.duration, sound=stimulus.speech is not None)
    if flaw is not None:
        yield flaw_finding(flaw, name, f"Replace it; lengths may differ by {DURATION_TOLERANCE} s")


def _format_findings(material: Material, formats: Mapping[Path, VideoFormat]) -> Iterator[Finding]:
    """Yield encodings that a browser may not play, or that tell a segment's videos apart."""
    study = material.study
    by_segment: defaultdict[str, dict[str, VideoFormat]] = defaultdict(dict)
    for file, video_format in formats.items():
        by_segment[material.finished[file][0].segment][material.display_path(file)] = video_format
    some_rendered = not all(study.is_finished(name) for name in study.conditions)
    rendered = VideoFormat.rendered(study.video.size, study.video.frame_rate)
    for finished in by_segment.values():
        remedy = encode_like(rendered if some_rendered else next(iter(finished.values())))
        for name, video_format in finished.items():
            if (reason := video_format.unplayable) is not None:
                yield make_finding(
                    "video-unplayable", f"{name} {reason}", where=name, remedy=remedy
                )
        compared = finished | ({"a rendered video": rendered} if some_rendered else {})
        for attribute, words in VideoFormat.WORDS.items():
            values: dict[object, str] = {}
            for name, video_format in compared.items():
                values.setdefault(getattr(video_format, attribute), name)
            if len(values) > 1:
                differences = ", ".join(f"{value} in {name}" for value, name in values.items())
                yield make_finding(
                    _DIFFERS[attribute],
                    f"{words} differs, which tells videos apart: {differences}",
                    where=next(iter(finished)),
                    remedy=remedy,
                )


def _resolution_findings(
    material: Material, formats: Mapping[Path, VideoFormat]
) -> Iterator[Finding]:
    """Yield videos that are too small, or whose frame rate is too low, to judge them."""
    video = material.study.video
    pixels, frame_rate, where = float(video.size), float(video.frame_rate), "video"
    if material.study.only_finished:
        if not formats:
            return
        pixels, smallest = min((min(f.width, f.height), file) for file, f in formats.items())
        frame_rate = min(video_format.frame_rate for video_format in formats.values())
        where = material.display_path(smallest)
    if pixels < LEAST_PIXELS:
        yield make_finding("picture-small", where=where, pixels=pixels)
    if frame_rate < LEAST_FRAME_RATE:
        yield make_finding("frame-rate-low", where=where, rate=frame_rate)
