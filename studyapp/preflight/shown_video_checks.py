"""Whether the files for participants are intact, what they reveal, and how much is loaded."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

from motion.errors import InputError, listed
from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.finished_video_checks import (
    encode_like,
    flaw_finding,
)
from studyapp.preflight.material import Material
from studyapp.preflight.time_checks import SAMPLED_PLACES
from studyapp.session.served_study import describe_content
from studyapp.stimuli.media_probe import (
    VideoStructure,
    flaw_of,
    format_of,
    read_metadata,
    structure_of,
)
from studyapp.stimuli.video_copies import out_of_date
from studyapp.study.design.trial import Content, PlannedTrial
from studyapp.study.finished_videos import finished_video_path, shows_copy, video_duration
from studyapp.study.media import VideoFile

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
        yield from _file_findings(material, content)
    for copy in out_of_date(material.folder):
        yield make_finding("copy-out-of-date", where=copy.file, copy=copy)
    by_segment: defaultdict[str, dict[str, VideoFile]] = defaultdict(dict)
    for content, video in material.shown.items():
        by_segment[content[0].segment][material.display_path(video.file)] = video
    yield from _size_findings(by_segment)
    yield from _metadata_findings(material, by_segment)
    yield from _structure_findings(material)


def _file_findings(material: Material, content: Content) -> Iterator[Finding]:
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
        yield flaw_finding(flaw, name, "Delete the file and run 'motionjury render'")
        return
    if stimulus.speech is None and (encoded := format_of(video.file)) and encoded.sound:
        yield make_finding("sound-unwanted", where=name)


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


def _metadata_findings(material: Material, by_segment: FilesBySegment) -> Iterator[Finding]:
    """Yield metadata that names a condition, or that not all videos of a segment have."""
    study = material.study
    conditions = {*study.conditions, study.catch.condition}
    for segment, videos in by_segment.items():
        # A video without sound has no sound stream to describe.
        metadata = {
            name: [entry for entry in read_metadata(video.file) if entry != _SOUND_STREAM]
            for name, video in videos.items()
        }
        naming = {
            name: mention
            for name, entries in metadata.items()
            if (mention := _mentioned_condition(entries, conditions))
        }
        for name, mention in naming.items():
            yield make_finding("metadata-tells", f"{name} says {mention}", where=name)
        common = set.intersection(*map(set, metadata.values()))
        unshared = [
            (name, entry)
            for name, entries in metadata.items()
            for entry in entries
            if entry not in common
        ]
        if unshared and not naming:
            name, entry = unshared[0]
            yield make_finding(
                "metadata-tells",
                f"{name} says {entry!r}, which other videos of segment {segment} do not",
                where=name,
            )


def _mentioned_condition(entries: Collection[str], conditions: Collection[str]) -> str:
    """Return the entry that holds a condition's name as a word; empty if none does."""
    for entry in entries:
        for name in sorted(conditions):
            word = rf"(?<![A-Za-z0-9]){re.escape(name)}(?![A-Za-z0-9])"
            if re.search(word, entry, re.IGNORECASE):
                return f"{entry!r}, which names the condition {name!r}"
    return ""


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
            remedy=encode_like(example),
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
