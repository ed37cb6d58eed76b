"""What can be wrong with a study's motion, found before it is shown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip
from motion.freeze import CHANNELS, freeze, moving_channels
from motion.listing import listed
from studyapp.definition.folder import StudyFolder
from studyapp.definition.study import Study
from studyapp.stages.finding import Finding, Severity, as_finding
from studyapp.stages.shown_body import left_out, shown_abilities


def motion_findings(folder: StudyFolder, study: Study) -> Iterator[Finding]:
    """Yield what is broken, what tells conditions apart, and what is not shown of them."""
    clips, broken = _read_motion(folder, study)
    yield from broken
    yield from _freeze_findings(study)
    yield from _kind_findings(study, clips)
    yield from _body_findings(folder, study, clips)


def _freeze_findings(study: Study) -> Iterator[Finding]:
    finished = [name for name in study.conditions if study.is_finished(name)]
    if study.freeze and finished:
        yield Finding(
            Severity.WARNING,
            f"freeze holds nothing still in the finished videos of {listed(finished)}",
            "Bring videos that hold it still: participants are told that it is",
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
                broken.append(as_finding(error))
            else:
                if condition in clips:
                    clips[condition].append(clip)
    return clips, broken


def _body_findings(
    folder: StudyFolder, study: Study, clips: Mapping[str, list[MotionClip]]
) -> Iterator[Finding]:
    """Say what of the motion the study's body leaves out."""
    try:
        body = shown_abilities(folder, study)
    except InputError as error:
        yield as_finding(error)
        return
    shown = ((name, freeze(clip, study.freeze)) for name, made in clips.items() for clip in made)
    for sentence in left_out(shown, body):
        yield Finding(Severity.WARNING, sentence)


def _kind_findings(study: Study, clips: Mapping[str, list[MotionClip]]) -> Iterator[Finding]:
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
