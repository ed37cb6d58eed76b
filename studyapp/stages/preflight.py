"""What can go wrong before a study is launched."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final

import numpy as np

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.freeze import CHANNELS, freeze, moving_channels
from motion.listing import listed
from motion.segment import EMOTIONS
from studyapp.definition.folder import StudyFolder
from studyapp.definition.media import Media
from studyapp.definition.study import Study
from studyapp.design.planned_trial import Kind
from studyapp.services.served_study import described
from studyapp.stages.media_probe import DURATION_TOLERANCE, flaw_of, loudness_of
from studyapp.stages.shown_body import left_out, shown_abilities

KIND_WORDS: Final[Mapping[Kind, str]] = MappingProxyType(
    {
        "practice": "practice (discarded)",
        "main": "main",
        "repeat": "practice ones again (analysed)",
        "catch": "catch",
        "attention": "attention",
    }
)


LOUDNESS_TOLERANCE: Final = 1.0
"""LU by which two videos may differ, as EBU R 128 allows live programmes."""


class Severity(Enum):
    """How much a finding matters."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Finding:
    """One finding: what it is, how much it matters, and what to do."""

    severity: Severity
    what: str
    remedy: str = ""


def check(folder: StudyFolder) -> list[Finding]:
    """Return everything worth knowing before launch, errors first.

    Raises
    ------
    InputError
        If the study file or the segments cannot be read at all.
    """
    study = folder.study()
    clips, broken = _read_motion(folder, study)
    findings = [
        *broken,
        *_media_findings(folder, study),
        *_freeze_findings(study),
        *_loudness_findings(folder, study),
        *_motion_findings(study, clips),
        *_body_findings(folder, study, clips),
        *_page_findings(study),
        *_design_findings(folder, study),
    ]
    order = list(Severity)
    return sorted(findings, key=lambda finding: order.index(finding.severity))


def _media_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    segments = {segment.name: segment for segment in folder.segments_of(study)}
    order = list(segments)
    contents = sorted(
        study.contents(tuple(segments.values())),
        key=lambda content: order.index(content[0].segment),
    )
    if not folder.stimuli.exists():
        yield Finding(Severity.ERROR, "the study has no videos yet", "Run 'motionjury render'")
        return
    media = Media.of(folder, study)
    sizes: defaultdict[str, set[int]] = defaultdict(set)
    for content in contents:
        segment = segments[content[0].segment]
        finished = study.is_finished(content[0].condition)
        again = "Bring it anew" if finished else "Delete the file and run 'motionjury render'"
        found = media.find(content)
        if found is None or not found.file.exists():
            yield Finding(
                Severity.ERROR,
                f"the video of {described(content)} is missing",
                f"Bring it as {found.file}" if finished and found else "Run 'motionjury render'",
            )
            continue
        sizes[segment.name].add(found.file.stat().st_size)
        name = found.file.relative_to(folder.root)
        if abs(found.duration - segment.duration) > (DURATION_TOLERANCE if finished else 1e-6):
            yield Finding(
                Severity.ERROR,
                f"{name} lasts {found.duration:g} s, its segment {segment.duration:g} s",
                "Bring videos of one length for each segment"
                if finished
                else "The segments changed: run 'motionjury generate' and 'motionjury render'",
            )
        elif (flaw := flaw_of(found.file, found.duration)) is not None:
            yield Finding(Severity.ERROR, f"{name} {flaw}", again)
    yield from _size_findings(sizes)


def _size_findings(sizes: Mapping[str, set[int]]) -> Iterator[Finding]:
    """Say where the size of a video tells what it shows, as after an interrupted rendering."""
    for segment, different in sizes.items():
        if len(different) > 1:
            yield Finding(
                Severity.ERROR,
                f"the videos of segment {segment} differ in file size, which tells them apart",
                "Run 'motionjury render'",
            )


def _freeze_findings(study: Study) -> Iterator[Finding]:
    finished = [name for name in study.conditions if study.is_finished(name)]
    if study.freeze and finished:
        yield Finding(
            Severity.WARNING,
            f"freeze holds nothing still in the finished videos of {listed(finished)}",
            "Bring videos that hold it still: participants are told that it is",
        )


def _loudness_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    """Say where videos sound louder than others; what is rendered of one speech sounds alike."""
    if not folder.stimuli.exists():
        return
    media = Media.of(folder, study)
    loudness: dict[str, float] = {}
    for content in study.contents(tuple(folder.segments_of(study))):
        shown, found = content[0], media.find(content)
        if shown.speech is None or found is None or not found.file.exists():
            continue
        finished = study.is_finished(shown.condition)
        name = str(found.file.relative_to(folder.root)) if finished else f"segment {shown.speech}"
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


def _page_findings(study: Study) -> Iterator[Finding]:
    for key, why in (
        ("organisation", "participants are not told who runs the study"),
        ("contact", "participants have nobody to ask"),
        ("payment", "participants are not told what they get"),
    ):
        if not getattr(study.page, key):
            yield Finding(Severity.WARNING, why, f"Fill in page.{key} in study.toml")


def _design_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    segments = folder.segments_of(study)
    plan = study.plan(study.arms[0], 0, segments)
    counts = Counter(trial.kind for trial in plan)
    said = ", ".join(
        f"{counts[kind]} {words}" for kind, words in KIND_WORDS.items() if counts[kind]
    )
    yield Finding(Severity.NOTE, f"a participant sees {len(plan)} trials: {said}")
    for sentence in (*study.notes(segments), *study_notes(study)):
        yield Finding(Severity.NOTE, sentence.rstrip("."))
    emotions = {segment.emotion for segment in segments}
    silent = [emotion for emotion in EMOTIONS if emotion not in emotions]
    if silent and any("{emotion}" in question.text for question in study.questions):
        yield Finding(Severity.NOTE, f"the results will say nothing about {listed(silent)}")
    if not study.catch.trials and not study.attention.trials:
        yield Finding(
            Severity.WARNING,
            "there are neither catch trials nor attention checks, so inattentive participants "
            "cannot be told apart",
            "Set catch.trials or attention.trials in study.toml",
        )


def _read_motion(
    folder: StudyFolder, study: Study
) -> tuple[dict[str, list[MotionClip]], list[Finding]]:
    """Return the clips that there are of each condition, and a finding for each broken one.

    Of the catch condition only what is broken is told: its motion is meant to look odd.
    """
    clips: dict[str, list[MotionClip]] = {condition: [] for condition in study.conditions}
    broken: list[Finding] = []
    caught = (study.catch.condition,) if study.catch.trials else ()
    moved = [name for name in (*study.conditions, *caught) if not study.is_finished(name)]
    segments = folder.segments_of(study)
    for condition in moved:
        for segment in segments:
            path = folder.clip(condition, segment.name)
            if not path.exists():
                continue
            try:
                clip = read_clip(path)
            except InputError as error:
                broken.append(_as_finding(error))
            else:
                if condition in clips:
                    clips[condition].append(clip)
    return clips, broken


def _as_finding(error: InputError) -> Finding:
    return Finding(Severity.ERROR, f"{error.where}: {error.what}", error.remedy)


def _body_findings(
    folder: StudyFolder, study: Study, clips: Mapping[str, list[MotionClip]]
) -> Iterator[Finding]:
    """Say what of the motion the study's body leaves out."""
    try:
        body = shown_abilities(folder, study)
    except InputError as error:
        yield _as_finding(error)
        return
    shown = ((name, freeze(clip, study.freeze)) for name, made in clips.items() for clip in made)
    for sentence in left_out(shown, body):
        yield Finding(Severity.WARNING, sentence)


def _motion_findings(study: Study, clips: Mapping[str, list[MotionClip]]) -> Iterator[Finding]:
    """Say where a condition's motion is of another kind than the others'."""
    for condition, made in clips.items():
        slowest = min((clip.frame_rate for clip in made), default=study.video.frame_rate)
        if slowest < study.video.frame_rate:
            yield Finding(
                Severity.WARNING,
                f"the motion of {condition!r} has {slowest:g} frames per second and is shown at "
                f"{study.video.frame_rate}: what lies between is interpolated, so its fast "
                "movements look smoother than they were",
                "Bring in the original at its full rate if there is one",
            )
    moving = {
        condition: frozenset().union(*(moving_channels(clip) for clip in made))
        for condition, made in clips.items()
        if any(np.ptp(clip.poses, axis=0).any() for clip in made)
    }
    for channel in CHANNELS:
        still = [condition for condition, channels in moving.items() if channel not in channels]
        if channel not in study.freeze and 0 < len(still) < len(moving):
            yield Finding(
                Severity.WARNING,
                f"{channel} never moves in {listed(still)} but does in the other conditions, "
                "which tells them apart",
                f'Add "{channel}" to freeze in study.toml and render again',
            )


def study_notes(study: Study) -> tuple[str, ...]:
    """Return what a reader of the results must know of the study's conditions."""
    if study.has_recording or not study.catch.trials:
        return ()
    return (
        "No condition is a recording of a person, so there is no ground truth: "
        f"catch trials show {study.catch_against} against {study.catch.condition}.",
    )
