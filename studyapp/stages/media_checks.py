"""What can be wrong with the videos that participants are shown, or tell them too much."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from motion.listing import listed
from motion.segment import Segment
from studyapp.definition.finished_videos import finished_video, shows_copy
from studyapp.definition.folder import StudyFolder
from studyapp.definition.media import Media, VideoFile
from studyapp.definition.study import Study
from studyapp.design.stimulus import Content
from studyapp.services.served_study import described
from studyapp.stages.finding import Finding, Severity
from studyapp.stages.media_probe import (
    DURATION_TOLERANCE,
    VideoFormat,
    VideoStructure,
    flaw_of,
    format_of,
    loudness_of,
    structure_of,
)
from studyapp.stages.video_copies import out_of_date

LOUDNESS_TOLERANCE: Final = 1.0
"""LU by which two videos may differ, as EBU R 128 allows live programmes."""

_ENCODE: Final = (
    "Encode all finished videos alike, as with 'ffmpeg -i IN.mp4 -r {rate:g} -s {width}x{height} "
    "-c:v libx264 -crf 18 -bf 0 -sc_threshold 0 -pix_fmt yuv420p -c:a aac -ar 48000 -ac 1 OUT.mp4'"
)


def media_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    """Yield what is missing or broken, and what tells videos apart before they are seen."""
    segments = {segment.name: segment for segment in folder.segments_of(study)}
    order = list(segments)
    contents = sorted(
        study.contents(tuple(segments.values())),
        key=lambda content: order.index(content[0].segment),
    )
    for content in _brought(folder, study, contents):
        yield from _original_findings(folder, content, segments[content[0].segment])
    yield from _format_findings(folder, study, contents)
    if not folder.stimuli.exists():
        yield Finding(Severity.ERROR, "the study has no videos yet", "Run 'motionjury render'")
        return
    media = Media.of(folder, study)
    for content in contents:
        yield from _shown_findings(folder, study, content, media, segments[content[0].segment])
    for copy in out_of_date(folder):
        yield Finding(
            Severity.ERROR,
            f"the video of {copy.condition!r} for segment {copy.segment} has changed since it was "
            "copied for the participants",
            "Run 'motionjury render'",
        )
    yield from _size_findings(media, contents)
    yield from _structure_findings(study, media, contents)
    yield from _loudness_findings(folder, study, contents, media)


def _brought(folder: StudyFolder, study: Study, contents: list[Content]) -> list[Content]:
    """Return the contents that need a finished video of their own."""
    files: dict[Path, Content] = {}
    for content in contents:
        if len(content) == 1 and study.is_finished(content[0].condition):
            files.setdefault(finished_video(folder.videos, content[0]), content)
    return list(files.values())


def _original_findings(
    folder: StudyFolder, content: Content, segment: Segment
) -> Iterator[Finding]:
    """Say what is wrong with a finished video."""
    (shown,) = content
    file = finished_video(folder.videos, shown)
    if not file.is_file():
        yield Finding(
            Severity.ERROR, f"the video of {described(content)} is missing", f"Bring it as {file}"
        )
        return
    name = file.relative_to(folder.root)
    flaw = flaw_of(file, segment.duration, sound=shown.speech is not None)
    if flaw is not None:
        yield Finding(
            Severity.ERROR,
            f"{name} {flaw}",
            f"Bring it anew; lengths may differ by {DURATION_TOLERANCE} s",
        )


def _format_findings(
    folder: StudyFolder, study: Study, contents: list[Content]
) -> Iterator[Finding]:
    """Say where videos are encoded so that a browser may not play them, or can tell them apart."""
    formats: defaultdict[str, dict[str, VideoFormat]] = defaultdict(dict)
    for content in _brought(folder, study, contents):
        file = finished_video(folder.videos, content[0])
        found = format_of(file)
        if found is not None:
            formats[content[0].segment][str(file.relative_to(folder.root))] = found
    drawn = any(not study.is_finished(name) for name in study.conditions)
    wanted = VideoFormat.rendered(study.video.size, study.video.frame_rate) if drawn else None
    for of_segment in formats.values():
        example = wanted or next(iter(of_segment.values()))
        remedy = _ENCODE.format(rate=example.frame_rate, width=example.width, height=example.height)
        for name, found in of_segment.items():
            if (why := found.unplayable) is not None:
                yield Finding(Severity.ERROR, f"{name} {why}", remedy)
        named = {**of_segment, **({"a rendered video": wanted} if wanted else {})}
        for attribute, words in VideoFormat.WORDS.items():
            of_value: dict[object, str] = {}
            for name, found in named.items():
                of_value.setdefault(getattr(found, attribute), name)
            if len(of_value) > 1:
                told = ", ".join(f"{value} in {name}" for value, name in of_value.items())
                yield Finding(
                    Severity.ERROR, f"{words} differs, which tells videos apart: {told}", remedy
                )


def _shown_findings(
    folder: StudyFolder, study: Study, content: Content, media: Media, segment: Segment
) -> Iterator[Finding]:
    """Say what is wrong with the file that participants get."""
    found = media.find(content)
    copied = shows_copy(study, content)
    finished = study.is_finished(content[0].condition)
    if found is None or not found.file.exists():
        if finished and not finished_video(folder.videos, content[0]).is_file():
            return
        made = "copied for the participants" if copied else "rendered"
        yield Finding(
            Severity.ERROR,
            f"the video of {described(content)} is missing: it was not {made}",
            "Run 'motionjury render'",
        )
        return
    name = found.file.relative_to(folder.root)
    if not copied and abs(found.duration - segment.duration) > 1e-6:
        yield Finding(
            Severity.ERROR,
            f"{name} lasts {found.duration:g} s, its segment {segment.duration:g} s",
            "The segments changed: run 'motionjury generate' and 'motionjury render'",
        )
        return
    flaw = flaw_of(found.file, found.duration, sound=content[0].speech is not None)
    if flaw is not None:
        yield Finding(
            Severity.ERROR, f"{name} {flaw}", "Delete the file and run 'motionjury render'"
        )


def _size_findings(media: Media, contents: list[Content]) -> Iterator[Finding]:
    """Say where the size of a video tells what it shows, as after an interrupted rendering."""
    sizes: defaultdict[str, set[int]] = defaultdict(set)
    for content in contents:
        found = media.find(content)
        if found is not None and found.file.exists():
            sizes[content[0].segment].add(found.file.stat().st_size)
    for segment, different in sizes.items():
        if len(different) > 1:
            yield Finding(
                Severity.ERROR,
                f"the videos of segment {segment} differ in file size, which tells them apart",
                "Run 'motionjury render'",
            )


def _structure_findings(study: Study, media: Media, contents: list[Content]) -> Iterator[Finding]:
    """Say where copies tell how their originals were encoded, to who takes the files apart."""
    beside: defaultdict[tuple[str, bool], dict[str, VideoFile]] = defaultdict(dict)
    for content in contents:
        found, shown = media.find(content), content[0]
        if found is not None and shows_copy(study, content) and found.file.exists():
            # The same motion with its own and with another speech differs in the sound alone.
            beside[shown.segment, shown.speech is None].setdefault(shown.condition, found)
    telling: dict[str, Path] = {}
    for of_condition in beside.values():
        files = [found.file for found in of_condition.values()]
        structures = [found for found in map(structure_of, files) if found is not None]
        for attribute, words in VideoStructure.WORDS.items():
            if len({getattr(structure, attribute) for structure in structures}) > 1:
                telling.setdefault(words, files[0])
    example = next(filter(None, map(format_of, telling.values())), None)
    if example is not None:
        yield Finding(
            Severity.WARNING,
            "files tell conditions apart to those who take them to pieces, by "
            f"{listed(list(telling))}",
            _ENCODE.format(rate=example.frame_rate, width=example.width, height=example.height),
        )


def _loudness_findings(
    folder: StudyFolder, study: Study, contents: list[Content], media: Media
) -> Iterator[Finding]:
    """Say where videos sound louder than others; what is rendered of one speech sounds alike."""
    loudness: dict[str, float] = {}
    for content in contents:
        shown, found = content[0], media.find(content)
        if shown.speech is None or found is None or not found.file.exists():
            continue
        name = f"segment {shown.speech}"
        if study.is_finished(shown.condition):
            name = str(finished_video(folder.videos, shown).relative_to(folder.root))
        if name not in loudness and (measured := loudness_of(found.file)) is not None:
            loudness[name] = measured
    if not loudness:
        return
    softest, loudest = (pick(loudness, key=lambda name: loudness[name]) for pick in (min, max))
    apart = loudness[loudest] - loudness[softest]
    if apart > LOUDNESS_TOLERANCE:
        yield Finding(
            Severity.WARNING,
            f"{loudest} is {apart:.1f} LU louder than {softest} "
            f"({loudness[loudest]:.1f} and {loudness[softest]:.1f} LUFS)",
            "Run 'motionjury render', and see what it says of the speech; bring finished videos "
            "at -23 LUFS, as rendered ones are",
        )
