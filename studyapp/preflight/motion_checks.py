"""Whether the motion can be read, is shown completely, and does not tell conditions apart."""

from collections.abc import Iterator, Mapping

import numpy as np

from motion.body.model import BodyModel
from motion.clip import CHANNELS, MotionClip, freeze, moving_channels
from motion.errors import InputError, listed
from motion.formats import read_clip
from studyapp.preflight.catch_checks import catch_motion_findings
from studyapp.preflight.finding import Finding, finding_of_error, make_finding
from studyapp.preflight.material import Material
from studyapp.stimuli.shown_motion import left_out, shown_body
from studyapp.study.settings.study import Study

ClipsBySegment = Mapping[str, Mapping[str, MotionClip]]


def motion_findings(material: Material) -> Iterator[Finding]:
    """Yield broken clips, motion that is not shown, and what tells conditions apart."""
    study = material.study
    clips, broken = _read_clips(material)
    yield from broken
    compared = {name: by_segment for name, by_segment in clips.items() if name in study.conditions}
    finished = [name for name in study.conditions if study.is_finished(name)]
    if study.freeze and finished:
        yield make_finding("freeze-without-effect", conditions=listed(finished))
    yield from _frame_rate_findings(study, compared)
    yield from _channel_findings(study, compared)
    yield from _body_findings(material, compared)
    yield from catch_motion_findings(study, clips)


def _read_clips(material: Material) -> tuple[dict[str, dict[str, MotionClip]], list[Finding]]:
    """Return clips by condition and segment, the catch condition's too, and the broken ones."""
    study, folder = material.study, material.folder
    flawed = (study.catch.condition,) if study.catch.trials else ()
    clips: dict[str, dict[str, MotionClip]] = {
        name: {} for name in (*study.conditions, *flawed) if not study.is_finished(name)
    }
    broken: list[Finding] = []
    for condition, by_segment in clips.items():
        for segment in material.segments:
            file = folder.clip(condition, segment.name)
            if not file.exists():
                continue
            try:
                by_segment[segment.name] = read_clip(file)
            except InputError as error:
                where = material.display_path(file)
                broken.append(finding_of_error("motion-unreadable", error, where=where))
    return clips, broken


def _frame_rate_findings(study: Study, clips: ClipsBySegment) -> Iterator[Finding]:
    for condition, by_segment in clips.items():
        rates = (clip.frame_rate for clip in by_segment.values())
        rate = min(rates, default=study.video.frame_rate)
        if rate < study.video.frame_rate:
            yield make_finding(
                "motion-interpolated",
                where=f"motion/{condition}",
                condition=condition,
                rate=rate,
                shown=study.video.frame_rate,
            )


def _channel_findings(study: Study, clips: ClipsBySegment) -> Iterator[Finding]:
    """Yield channels that move in some conditions only."""
    moving = {
        condition: frozenset().union(*map(moving_channels, by_segment.values()))
        for condition, by_segment in clips.items()
        if any(np.ptp(clip.poses, axis=0).any() for clip in by_segment.values())
    }
    for channel in CHANNELS:
        still = [condition for condition, channels in moving.items() if channel not in channels]
        if channel not in study.freeze and 0 < len(still) < len(moving):
            yield make_finding(
                "channel-tells-apart",
                channel=channel,
                conditions=listed(still),
                remedy=f'Add "{channel}" to freeze in study.toml and render again',
            )


def _body_findings(material: Material, clips: ClipsBySegment) -> Iterator[Finding]:
    """Yield what the study's body or its camera does not show of the motion."""
    study = material.study
    try:
        body = shown_body(material.folder, study)
    except InputError as error:
        where = error.where.removeprefix(f"{material.folder.root}/")
        yield finding_of_error("body-unusable", error, where=where)
        return
    yield from _shape_findings(clips, body.shape_directions.shape[2])
    frozen = [
        (name, freeze(clip, study.freeze))
        for name, by_segment in clips.items()
        for clip in by_segment.values()
    ]
    for sentence in left_out(frozen, body):
        yield make_finding("motion-not-shown", sentence.rstrip("."))
    if frozen:
        yield from _framing_findings(study, body)


def _shape_findings(clips: ClipsBySegment, known: int) -> Iterator[Finding]:
    """Yield the conditions whose betas, the first `known`, differ from the first condition's."""
    shapes = {
        condition: {
            segment: tuple(np.trim_zeros(clip.betas[:known].round(2), "b"))
            for segment, clip in by_segment.items()
        }
        for condition, by_segment in clips.items()
    }
    first = next(iter(shapes), "")
    others = [
        condition
        for condition, by_segment in shapes.items()
        if any(shape != shapes[first].get(segment, shape) for segment, shape in by_segment.items())
    ]
    if others:
        yield make_finding("shape-tells-apart", conditions=listed(others), other=first)


def _framing_findings(study: Study, body: BodyModel) -> Iterator[Finding]:
    """Yield a framing on what does not move."""
    part = study.video.framing if study.video.framing in ("face", "hands") else ""
    if part in study.freeze:
        yield make_finding("framed-part-still", framing=part, why="freeze holds it still")
    elif part == "face" and not body.expression_directions.size:
        yield make_finding("framed-part-still", framing=part, why="the study's body has no face")
