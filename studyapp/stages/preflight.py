"""What can go wrong before a study is launched."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Final

import numpy as np

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.freeze import CHANNELS, freeze, moving_channels
from motion.listing import listed
from motion.segment import EMOTIONS
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import read_stimuli
from studyapp.definition.study import Study
from studyapp.design.trial_count import planned_trials
from studyapp.stages.media_probe import flaw_of, loudness_of
from studyapp.stages.shown_body import left_out, shown_abilities

PUBLISHED_PAIRS: Final = 24
"""Pairs that a participant of AMUSE's study judged (Chhatre et al. 2024, section 5.3)."""


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
        *_size_findings(folder),
        *_loudness_findings(folder),
        *_motion_findings(study, clips),
        *_body_findings(folder, study, clips),
        *_page_findings(study),
        *_design_findings(folder, study),
    ]
    order = list(Severity)
    return sorted(findings, key=lambda finding: order.index(finding.severity))


def _media_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    if not folder.stimuli.exists():
        yield Finding(Severity.ERROR, "the study has no videos yet", "Run 'motionjury render'")
        return
    segments = folder.segments()
    stimuli = read_stimuli(folder.stimuli)
    pairs = {(pair.segment, pair.left, pair.right): pair for pair in stimuli.pairs}
    for segment in segments:
        for left, right in study.pairs:
            pair = pairs.get((segment.name, left, right))
            if pair is None or not (folder.root / pair.file).exists():
                yield Finding(
                    Severity.ERROR,
                    f"the video of {left!r} beside {right!r} for segment {segment.name} is missing",
                    "Run 'motionjury render'",
                )
            elif abs(pair.duration - segment.duration) > 1e-6:
                yield Finding(
                    Severity.ERROR,
                    f"{pair.file} lasts {pair.duration:g} s, its segment {segment.duration:g} s",
                    "The segments changed: run 'motionjury generate' and 'motionjury render'",
                )
            elif (flaw := flaw_of(folder.root / pair.file, pair.duration)) is not None:
                yield Finding(
                    Severity.ERROR,
                    f"{pair.file} {flaw}",
                    "Delete the file and run 'motionjury render'",
                )


def _size_findings(folder: StudyFolder) -> Iterator[Finding]:
    """Say where the size of a video tells what it shows, as after an interrupted rendering."""
    if not folder.stimuli.exists():
        return
    sizes: defaultdict[str, set[int]] = defaultdict(set)
    for pair in read_stimuli(folder.stimuli).pairs:
        path = folder.root / pair.file
        if path.exists():
            sizes[pair.segment].add(path.stat().st_size)
    for segment, different in sizes.items():
        if len(different) > 1:
            yield Finding(
                Severity.ERROR,
                f"the pairs of segment {segment} differ in file size, which tells them apart",
                "Run 'motionjury render'",
            )


def _loudness_findings(folder: StudyFolder) -> Iterator[Finding]:
    """Say where videos sound louder than others; the pairs of one segment share their sound."""
    if not folder.stimuli.exists():
        return
    loudness: dict[str, float] = {}
    for pair in read_stimuli(folder.stimuli).pairs:
        path = folder.root / pair.file
        if pair.segment in loudness or not path.exists():
            continue
        measured = loudness_of(path)
        if measured is not None:
            loudness[pair.segment] = measured
    if not loudness:
        return
    softest, loudest = (pick(loudness, key=lambda name: loudness[name]) for pick in (min, max))
    apart = loudness[loudest] - loudness[softest]
    if apart > LOUDNESS_TOLERANCE:
        yield Finding(
            Severity.WARNING,
            f"segment {loudest} is {apart:.1f} LU louder than segment {softest} "
            f"({loudness[loudest]:.1f} and {loudness[softest]:.1f} LUFS)",
            "Run 'motionjury render', and see what it says of the speech",
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
    segments = folder.segments()
    count = planned_trials(study, segments)
    emotions = [e for e in EMOTIONS if e in {segment.emotion for segment in segments}]
    yield Finding(
        Severity.NOTE,
        f"{len(segments)} segments of {listed(emotions)} allow {count.analysed} pairs per "
        f"participant; the published design has {PUBLISHED_PAIRS}, three for each of "
        f"{len(EMOTIONS)} emotions",
    )
    yield Finding(
        Severity.NOTE,
        f"a participant sees {count.presentations} trials: {count.practice} practice (discarded), "
        f"{count.main} main, {count.repeat} practice ones again (analysed), {count.catch} catch",
    )
    for sentence in count.sentences:
        yield Finding(Severity.NOTE, sentence)
    silent = [emotion for emotion in EMOTIONS if emotion not in emotions]
    if silent and any("{emotion}" in question.text for question in study.questions):
        yield Finding(Severity.NOTE, f"the results will say nothing about {listed(silent)}")
    for sentence in study_notes(study):
        yield Finding(Severity.NOTE, sentence.rstrip("."))
    if not study.catch.trials:
        yield Finding(
            Severity.WARNING,
            "there are no catch trials, so inattentive participants cannot be told apart",
            "Set catch.trials in study.toml",
        )


def _read_motion(
    folder: StudyFolder, study: Study
) -> tuple[dict[str, list[MotionClip]], list[Finding]]:
    """Return the clips that there are of each condition, and a finding for each broken one.

    Of the catch condition only what is broken is told: its motion is meant to look odd.
    """
    clips: dict[str, list[MotionClip]] = {condition: [] for condition in study.conditions}
    broken: list[Finding] = []
    for condition in dict.fromkeys((*study.conditions, *study.shown_conditions)):
        for segment in folder.segments():
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
