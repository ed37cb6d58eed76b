"""What can be wrong with the files that participants get, what those tell, and their weight."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from motion.errors import InputError, listed
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.finished_video_checks import (
    encode_like,
    flaw_finding,
)
from studyapp.preflight.material import Material
from studyapp.session.served_study import described
from studyapp.stimuli.media_probe import (
    VideoStructure,
    flaw_of,
    format_of,
    structure_of,
    written_in,
)
from studyapp.stimuli.video_copies import out_of_date
from studyapp.study.design.trial import Content, PlannedTrial
from studyapp.study.finished_videos import finished_video_path, shows_copy, video_duration
from studyapp.study.media import VideoFile

RENDER: Final = "Run 'motionjury render'"


_OF_SOUND: Final = "handler_name: SoundHandler"

LENGTH_TOLERANCE: Final = 0.05
"""Seconds by which the files of one speech may differ: less than two frames."""


MEGABYTE: Final = 10**6

PLACES: Final = 24
"""Places of each arm whose trials are planned to find the heaviest page."""


def shown_video_findings(material: Material) -> Iterator[Finding]:
    """Yield what is missing or broken of what participants get, and what it gives away."""
    if material.media is None:
        yield finding("nothing-rendered")
        return
    for content in material.contents:
        yield from _shown_findings(material, content)
    for copy in out_of_date(material.folder):
        yield finding("copy-out-of-date", where=copy.file, copy=copy)
    beside = _beside_each_other(material)
    yield from _size_findings(beside)
    yield from _written_findings(material, beside)
    yield from _structure_findings(material)


def _shown_findings(material: Material, content: Content) -> Iterator[Finding]:
    """Say what is wrong with the file that participants get."""
    study, shown = material.study, content[0]
    copied = shows_copy(study, content)
    found = material.shown.get(content)
    if found is None:
        original = finished_video_path(material.folder.videos, shown)
        if study.is_finished(shown.condition) and not original.is_file():
            return
        made = "copied for the participants" if copied else "rendered"
        yield finding(
            "video-missing",
            f"the video of {described(content)} is missing: it was not {made}",
            where=f"videos of segment {shown.segment}",
            remedy=RENDER,
        )
        return
    name = material.name_of(found.file)
    segment = material.by_name[shown.segment]
    if not copied and abs(found.duration - segment.duration) > 1e-6:
        yield finding(
            "video-length",
            f"{name} lasts {found.duration:g} s, its segment {segment.duration:g} s",
            where=name,
            remedy="The segments changed: run 'motionjury generate' and 'motionjury render'",
        )
        return
    flaw = flaw_of(found.file, found.duration, sound=shown.speech is not None)
    if flaw is not None:
        yield flaw_finding(flaw, name, "Delete the file and run 'motionjury render'")
        return
    if shown.speech is None and (encoded := format_of(found.file)) and encoded.sound:
        yield finding("sound-unwanted", where=name)


def _beside_each_other(material: Material) -> Mapping[str, Mapping[str, VideoFile]]:
    """Return the files of each segment that must not be told apart, under their names."""
    beside: defaultdict[str, dict[str, VideoFile]] = defaultdict(dict)
    for content, video in material.shown.items():
        beside[content[0].segment][material.name_of(video.file)] = video
    return beside


def _size_findings(beside: Mapping[str, Mapping[str, VideoFile]]) -> Iterator[Finding]:
    """Say where a file's size or stated length tells what it shows."""
    for segment, files in beside.items():
        sizes = {video.file.stat().st_size for video in files.values()}
        if len(sizes) > 1:
            yield finding("sizes-differ", where=next(iter(files)), segment=segment)
        lengths = [lasts for video in files.values() if (lasts := _seconds_of(video.file))]
        if lengths and max(lengths) - min(lengths) > LENGTH_TOLERANCE:
            yield finding(
                "lengths-differ",
                where=next(iter(files)),
                segment=segment,
                shortest=min(lengths),
                longest=max(lengths),
            )


def _seconds_of(file: Path) -> float | None:
    """Return how long a video really lasts; None where it cannot be opened, which is said apart."""
    try:
        return video_duration(file)
    except InputError:
        return None


def _written_findings(
    material: Material, beside: Mapping[str, Mapping[str, VideoFile]]
) -> Iterator[Finding]:
    """Say where what is written in a file names a condition, or is not in the file beside it."""
    study = material.study
    names = {*study.conditions, study.catch.condition}
    for segment, files in beside.items():
        # A video without sound has one stream less to say something of.
        said = {
            name: [text for text in written_in(video.file) if text != _OF_SOUND]
            for name, video in files.items()
        }
        naming = {name: named for name, texts in said.items() if (named := _named(texts, names))}
        for name, named in naming.items():
            yield finding("metadata-tells", f"{name} says {named}", where=name)
        common = set.intersection(*map(set, said.values()))
        odd = [(name, text) for name, texts in said.items() for text in texts if text not in common]
        if odd and not naming:
            name, text = odd[0]
            yield finding(
                "metadata-tells",
                f"{name} says {text!r}, which other videos of segment {segment} do not",
                where=name,
            )


def _named(texts: Collection[str], names: Collection[str]) -> str:
    """Return the text that holds one of `names` as a word; empty where none does."""
    for text in texts:
        for name in sorted(names):
            if re.search(rf"(?<![A-Za-z0-9]){re.escape(name)}(?![A-Za-z0-9])", text, re.IGNORECASE):
                return f"{text!r}, which names the condition {name!r}"
    return ""


def _structure_findings(material: Material) -> Iterator[Finding]:
    """Say where copies tell how their originals were encoded, to who takes the files apart."""
    beside: defaultdict[tuple[str, bool], dict[str, VideoFile]] = defaultdict(dict)
    for content, video in material.shown.items():
        shown = content[0]
        if shows_copy(material.study, content):
            # The same motion with its own and with another speech differs in the sound alone.
            beside[shown.segment, shown.speech is None].setdefault(shown.condition, video)
    telling: dict[str, Path] = {}
    for of_condition in beside.values():
        files = [video.file for video in of_condition.values()]
        structures = [found for found in map(structure_of, files) if found is not None]
        for attribute, words in VideoStructure.WORDS.items():
            if len({getattr(structure, attribute) for structure in structures}) > 1:
                telling.setdefault(words, files[0])
    example = next(filter(None, map(format_of, telling.values())), None)
    if example is not None:
        yield finding(
            "structure-tells",
            differences=listed(list(telling)),
            where=material.name_of(next(iter(telling.values()))),
            remedy=encode_like(example),
        )


def weight_of(plan: Sequence[PlannedTrial], sizes: Mapping[Content, int]) -> tuple[int, int]:
    """Return the bytes that the heaviest page of a study session loads, and all pages together.

    A page loads its own videos, and fetches ahead those of the next one, which are loaded once.

    Parameters
    ----------
    plan : sequence of PlannedTrial
        The trials in their order.
    sizes : mapping of Content to int
        Bytes of each video; those that are not there count nothing.
    """
    pages = [sum(sizes.get(content, 0) for content in trial.shown) for trial in plan]
    with_next = [here + after for here, after in zip(pages, [*pages[1:], 0], strict=False)]
    return max(with_next, default=0), sum(pages)


def weight_findings(material: Material) -> Iterator[Finding]:
    """Say how much participants load, and whether a page loads more than the study allows."""
    sizes = {content: video.file.stat().st_size for content, video in material.shown.items()}
    if not sizes:
        return
    weights = [weight_of(plan, sizes) for _, plans in material.planned for plan in plans[:PLACES]]
    heaviest, total = map(max, zip(*weights, strict=True))
    yield finding("page-weight", page=heaviest / MEGABYTE, total=total / MEGABYTE)
    allowed = material.study.watching.megabytes_per_page
    if heaviest > allowed * MEGABYTE:
        yield finding("page-heavy", page=heaviest / MEGABYTE, allowed=allowed)
