"""What can be wrong with a study's motion, found before it is shown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from motion.clip import CHANNELS, MotionClip, freeze, moving_channels
from motion.errors import InputError, listed
from motion.formats import read_clip
from studyapp.preflight.catch_checks import catch_motion_findings
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.look_checks import look_findings
from studyapp.preflight.material import Material
from studyapp.stimuli.shown_motion import left_out, shown_abilities
from studyapp.study.settings.study import Study


def motion_findings(material: Material) -> Iterator[Finding]:
    """Yield what is broken, what tells conditions apart, and what is not shown of them."""
    clips, broken = _read_motion(material)
    yield from broken
    study = material.study
    compared = {
        name: list(made.values()) for name, made in clips.items() if name in study.conditions
    }
    yield from _freeze_findings(study)
    yield from _kind_findings(study, compared)
    yield from _body_findings(material, compared)
    yield from catch_motion_findings(study, clips)


def _freeze_findings(study: Study) -> Iterator[Finding]:
    finished = [name for name in study.conditions if study.is_finished(name)]
    if study.freeze and finished:
        yield finding("freeze-without-effect", conditions=listed(finished))


def _read_motion(
    material: Material,
) -> tuple[dict[str, dict[str, MotionClip]], list[Finding]]:
    """Return the clips of each condition by segment, and a finding for each broken one.

    The catch condition is among them: it is read, and what is broken of it is told, although its
    motion is meant to look odd.
    """
    study, folder = material.study, material.folder
    caught = (study.catch.condition,) if study.catch.trials else ()
    clips: dict[str, dict[str, MotionClip]] = {
        name: {} for name in (*study.conditions, *caught) if not study.is_finished(name)
    }
    broken: list[Finding] = []
    for condition, made in clips.items():
        for segment in material.segments:
            path = folder.clip(condition, segment.name)
            if not path.exists():
                continue
            try:
                made[segment.name] = read_clip(path)
            except InputError as unusable:
                broken.append(
                    finding(
                        "motion-unreadable",
                        unusable.what,
                        where=material.name_of(path),
                        remedy=unusable.remedy,
                    )
                )
    return clips, broken


def _body_findings(material: Material, clips: Mapping[str, list[MotionClip]]) -> Iterator[Finding]:
    """Say what of the motion the study's body, or its camera, leaves out."""
    study = material.study
    try:
        body = shown_abilities(material.folder, study)
    except InputError as unusable:
        yield finding(
            "body-unusable",
            unusable.what,
            where=unusable.where.removeprefix(f"{material.folder.root}/"),
            remedy=unusable.remedy,
        )
        return
    shown = ((name, freeze(clip, study.freeze)) for name, made in clips.items() for clip in made)
    for sentence in left_out(shown, body):
        yield finding("motion-not-shown", sentence.rstrip("."))
    yield from look_findings(material, body, clips)


def _kind_findings(study: Study, clips: Mapping[str, list[MotionClip]]) -> Iterator[Finding]:
    """Say where a condition's motion is of another kind than the others'."""
    for condition, made in clips.items():
        slowest = min((clip.frame_rate for clip in made), default=study.video.frame_rate)
        if slowest < study.video.frame_rate:
            yield finding(
                "motion-interpolated",
                where=f"motion/{condition}",
                condition=condition,
                rate=slowest,
                shown=study.video.frame_rate,
            )
    moving = {
        condition: frozenset().union(*(moving_channels(clip) for clip in made))
        for condition, made in clips.items()
        if any(np.ptp(clip.poses, axis=0).any() for clip in made)
    }
    for channel in CHANNELS:
        still = [condition for condition, channels in moving.items() if channel not in channels]
        if channel not in study.freeze and 0 < len(still) < len(moving):
            yield finding(
                "channel-tells-apart",
                channel=channel,
                conditions=listed(still),
                remedy=f'Add "{channel}" to freeze in study.toml and render again',
            )
