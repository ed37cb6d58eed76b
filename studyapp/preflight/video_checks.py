"""Whether finished videos and those of participants are intact, alike, and reveal nothing.

Finished videos are what the researcher supplies; participants are shown copies of them, and what is
rendered.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

from motion.errors import InputError, listed
from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import Material
from studyapp.preflight.time_checks import SAMPLED_PLACES
from studyapp.session.served_study import describe_content
from studyapp.stimuli.media_probe import (
    DURATION_TOLERANCE,
    Flaw,
    VideoFormat,
    VideoStructure,
    flaw_of,
    format_of,
    read_metadata,
    structure_of,
)
from studyapp.stimuli.video_copies import out_of_date
from studyapp.study.design.trial import Content, PlannedTrial
from studyapp.study.folder import similar_file, video_duration
from studyapp.study.media import VideoFile, finished_video_path, shows_copy

_DIFFERS: Final[Mapping[str, str]] = {
    "size": "picture-size-differs",
    "frame_rate": "frame-rate-differs",
    "picture": "picture-format-differs",
    "sound": "sound-format-differs",
}
"""Must be the same in all videos shown side by side; the findings if it is not."""

LEAST_PIXELS: Final = 360
"""Of the shorter side: below, the hands of an upper body are about ten pixels wide."""

LEAST_FRAME_RATE: Final = 24
"""As in films; below, motion is seen as single pictures."""

ENCODE: Final = (
    "Encode all finished videos alike, as with 'ffmpeg -i IN.mp4 -r {rate:g} -s {width}x{height} "
    "-c:v libx264 -crf 18 -bf 0 -sc_threshold 0 -pix_fmt yuv420p -c:a aac -ar 48000 -ac 1 OUT.mp4'"
)


def _encode_like(example: VideoFormat) -> str:
    """Return the remedy of encoding all videos as `example` is."""
    return ENCODE.format(rate=example.frame_rate, width=example.width, height=example.height)


def finished_video_findings(material: Material) -> Iterator[Finding]:
    """Yield finished videos that are missing or damaged, and how they differ."""
    for file, content in material.finished.items():
        yield from _finished_file_findings(material, file, content)
    formats = {
        file: video_format
        for file in material.finished
        if (video_format := format_of(file)) is not None
    }
    yield from _format_findings(material, formats)
    yield from _resolution_findings(material, formats)


def _flaw_finding(flaw: Flaw, name: str, remedy: str) -> Finding:
    """Return the finding of a flaw in the video `name`."""
    return make_finding(flaw.kind, f"{name} {flaw.what}", where=name, remedy=remedy)


def _finished_file_findings(material: Material, file: Path, content: Content) -> Iterator[Finding]:
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
        yield _flaw_finding(flaw, name, f"Replace it; lengths may differ by {DURATION_TOLERANCE} s")


def _format_findings(material: Material, formats: Mapping[Path, VideoFormat]) -> Iterator[Finding]:
    """Yield encodings that a browser may not play, or that tell a segment's videos apart."""
    study = material.study
    by_segment: defaultdict[str, dict[str, VideoFormat]] = defaultdict(dict)
    for file, video_format in formats.items():
        by_segment[material.finished[file][0].segment][material.display_path(file)] = video_format
    some_rendered = not all(study.is_finished(name) for name in study.conditions)
    rendered = VideoFormat.rendered(study.video.size, study.video.frame_rate)
    for finished in by_segment.values():
        remedy = _encode_like(rendered if some_rendered else next(iter(finished.values())))
        for name, video_format in finished.items():
            if (reason := video_format.unplayable) is not None:
                yield make_finding(
                    "video-unplayable", f"{name} {reason}", where=name, remedy=remedy
                )
        compared = finished | ({"a rendered video": rendered} if some_rendered else {})
        for attribute, finding in _DIFFERS.items():
            values: dict[object, str] = {}
            for name, video_format in compared.items():
                values.setdefault(getattr(video_format, attribute), name)
            if len(values) > 1:
                differences = ", ".join(f"{value} in {name}" for value, name in values.items())
                yield make_finding(
                    finding,
                    where=next(iter(finished)),
                    remedy=remedy,
                    differences=differences,
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


_SOUND_STREAM: Final = "handler_name: SoundHandler"

LENGTH_TOLERANCE: Final = 0.05
"""Seconds by which the files of a segment may differ: less than two frames."""

MEGABYTE: Final = 10**6

FilesBySegment = Mapping[str, Mapping[str, VideoFile]]
"""The videos of each segment, which must not be told apart, by display path."""


def shown_video_findings(material: Material) -> Iterator[Finding]:
    """Yield missing and damaged files of participants, and what the files reveal."""
    if material.media is None:
        yield make_finding("nothing-rendered")
        return
    for content in material.contents:
        yield from _shown_file_findings(material, content)
    for copy in out_of_date(material.folder):
        yield make_finding("copy-out-of-date", where=copy.file, copy=copy)
    by_segment: defaultdict[str, dict[str, VideoFile]] = defaultdict(dict)
    for content, video in material.shown.items():
        by_segment[content[0].segment][material.display_path(video.file)] = video
    yield from _size_findings(by_segment)
    yield from _metadata_findings(by_segment)
    yield from _structure_findings(material)


def _shown_file_findings(material: Material, content: Content) -> Iterator[Finding]:
    study, stimulus = material.study, content[0]
    copied = shows_copy(study, content)
    video = material.shown.get(content)
    if video is None:
        original = finished_video_path(material.folder.videos, stimulus)
        if study.is_finished(stimulus.condition) and not original.is_file():
            return  # reported by the checks of finished videos
        step = "copied for participants" if copied else "rendered"
        yield make_finding(
            "video-missing",
            f"the video of {describe_content(content)} is missing: it was not {step}",
            where=f"videos of segment {stimulus.segment}",
        )
        return
    name = material.display_path(video.file)
    segment = material.segments_by_name[stimulus.segment]
    if not copied and abs(video.duration - segment.duration) > 1e-6:
        yield make_finding(
            "video-length",
            f"{name} lasts {video.duration:g} s, its segment {segment.duration:g} s",
            where=name,
            remedy="The segments changed: run 'motionjury generate' and 'motionjury render'",
        )
        return
    flaw = flaw_of(video.file, video.duration, sound=stimulus.speech is not None)
    if flaw is not None:
        yield _flaw_finding(flaw, name, "Delete the file and run 'motionjury render'")


def _size_findings(by_segment: FilesBySegment) -> Iterator[Finding]:
    """Yield segments whose videos differ in file size or length."""
    for segment, videos in by_segment.items():
        first = next(iter(videos))
        if len({video.file.stat().st_size for video in videos.values()}) > 1:
            yield make_finding("sizes-differ", where=first, segment=segment)
        lengths: list[float] = []
        for video in videos.values():
            with suppress(InputError):  # a damaged file is reported already
                lengths.append(video_duration(video.file))
        if lengths and max(lengths) - min(lengths) > LENGTH_TOLERANCE:
            yield make_finding(
                "lengths-differ",
                where=first,
                segment=segment,
                shortest=min(lengths),
                longest=max(lengths),
            )


def _metadata_findings(by_segment: FilesBySegment) -> Iterator[Finding]:
    """Yield metadata that most videos do not have, such as a title that names a condition."""
    # A video without sound has no sound stream to describe.
    metadata = {
        name: frozenset(read_metadata(video.file)) - {_SOUND_STREAM}
        for videos in by_segment.values()
        for name, video in videos.items()
    }
    usual = Counter(metadata.values()).most_common(1)
    for name, entries in metadata.items():
        if different := sorted(entries ^ usual[0][0]):
            yield make_finding(
                "metadata-tells",
                f"{name} differs from other videos in {', '.join(map(repr, different))}",
                where=name,
            )


def _structure_findings(material: Material) -> Iterator[Finding]:
    """Yield copies whose files show how differently their originals were encoded."""
    groups: defaultdict[tuple[str, bool], dict[str, Path]] = defaultdict(dict)
    for content, video in material.shown.items():
        stimulus = content[0]
        if shows_copy(material.study, content):
            # The same motion with its own and with another speech differs in its sound only.
            groups[stimulus.segment, stimulus.speech is None].setdefault(
                stimulus.condition, video.file
            )
    differing: dict[str, Path] = {}
    for files in groups.values():
        structures = [structure for structure in map(structure_of, files.values()) if structure]
        for attribute, words in VideoStructure.WORDS.items():
            if len({getattr(structure, attribute) for structure in structures}) > 1:
                differing.setdefault(words, next(iter(files.values())))
    example = next(filter(None, map(format_of, differing.values())), None)
    if example is not None:
        yield make_finding(
            "structure-tells",
            differences=listed(list(differing)),
            where=material.display_path(next(iter(differing.values()))),
            remedy=_encode_like(example),
        )


def weight_of(plan: Sequence[PlannedTrial], sizes: Mapping[Content, int]) -> tuple[int, int]:
    """Return the bytes that the heaviest page of a study session loads, and that all pages load.

    A page loads its own videos and prefetches those of the next page, which are loaded only once.

    Parameters
    ----------
    plan : sequence of PlannedTrial
        The trials in their order.
    sizes : mapping of Content to int
        Bytes of each video; missing videos count as 0.
    """
    pages = [sum(sizes.get(content, 0) for content in trial.shown) for trial in plan]
    with_next = [page + following for page, following in zip(pages, [*pages[1:], 0], strict=True)]
    return max(with_next, default=0), sum(pages)


def weight_findings(material: Material) -> Iterator[Finding]:
    """Yield how much participants load, and whether a page exceeds the study's limit."""
    sizes = {content: video.file.stat().st_size for content, video in material.shown.items()}
    if not sizes:
        return
    weights = [
        weight_of(plan, sizes) for _, plans in material.planned for plan in plans[:SAMPLED_PLACES]
    ]
    heaviest, total = map(max, zip(*weights, strict=True))
    yield make_finding("page-weight", page=heaviest / MEGABYTE, total=total / MEGABYTE)
    allowed = material.study.watching.megabytes_per_page
    if heaviest > allowed * MEGABYTE:
        yield make_finding("page-heavy", page=heaviest / MEGABYTE, allowed=allowed)
