"""The subject of a study's report: texts, metrics and stills."""

import base64
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from av.video.frame import VideoFrame
from av.video.reformatter import VideoReformatter
from PIL import Image

from analysis.measurement.presets import PRESETS, REPORT
from analysis.metrics.scores import StudyMetrics
from analysis.report.content import Origin, Still, Subject
from analysis.report.sections.metrics import PAPER_OF
from motion.audio import read_audio
from motion.errors import InputError
from motion.files import sha256_of
from motion.segment import Segment
from renderer.figures.sheet import pictures_of, small_picture
from renderer.figures.strip import Moment, even_moments, loud_moments
from studyapp.results.analysed_tasks import compared_conditions
from studyapp.results.metrics import measure_study
from studyapp.study.folder import StudyFolder, video_duration
from studyapp.study.media import stimulus_videos
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.conditions import study_notes
from studyapp.study.settings.questions import SCALE_STEPS
from studyapp.study.settings.study import GROUND_TRUTH, Study


def study_subject(
    folder: StudyFolder,
    study: Study,
    segments: Sequence[Segment],
    *,
    origin: Origin,
    notes: Sequence[str] = (),
) -> Subject:
    """Return the subject of a study's report, with metrics and stills."""
    stills, no_stills = study_stills(folder, study, segments)
    return Subject(
        title=study.title,
        origin=origin,
        protocol=study.protocol,
        conditions=compared_conditions(study),
        labels=study.display_names,
        questions={question.name: question.text for question in study.questions},
        reference=study.reference
        if isinstance(study, PairwiseStudy) and study.has_reference_arms
        else None,
        recorded=GROUND_TRUTH if study.has_recording else None,
        generative={
            name: condition.generative
            for name, condition in study.conditions.items()
            if condition.generative is not None
        },
        broken=study.catch.condition if study.catch.trials else None,
        scale_labels=_scale_labels(study),
        excerpts={segment.name: segment for segment in segments},
        notes=(*study_notes(study), *notes),
        frozen=study.freeze,
        study_sha256=sha256_of(folder.definition),
        seed=study.seed,
        metrics=_metrics(folder, study, segments),
        stills=stills,
        no_stills=no_stills,
    )


def _scale_labels(study: Study) -> Mapping[str, tuple[str, ...]]:
    """Return the labels of scales with a label for each answer."""
    if not isinstance(study, RatingStudy):
        return {}
    return {
        question.name: tuple(question.labels)
        for question in study.questions
        if len(question.values) == SCALE_STEPS
    }


def _metrics(folder: StudyFolder, study: Study, segments: Sequence[Segment]) -> StudyMetrics | None:
    """Measure the study's motions; None where all its videos were brought finished."""
    has_motion = any(
        folder.clip(condition, segment.name).is_file()
        for condition in study.conditions
        for segment in segments
    )
    if not has_motion:
        return None
    return measure_study(folder, presets=report_presets(study), processes=1)


def report_presets(study: Study) -> tuple[str, ...]:
    """Return the metrics of a report: the usual ones, and those of the papers that it follows.

    These are the protocol's paper and the papers of the study's generators.
    """
    systems = (condition.generator for condition in study.conditions.values())
    papers = (PAPER_OF[study.protocol], *(name for name in systems if name in PRESETS))
    return tuple(dict.fromkeys((REPORT, *(name for name in papers if name is not None))))


STILL_COUNT: Final = 6
"""Moments that fit side by side on a page."""

STILL_PIXELS: Final = 240
"""Of the longer side of a still."""

_QUALITY: Final = 80

NO_VIDEOS: Final = "There are no videos of the conditions here, so there are no stills of them."


def study_stills(
    folder: StudyFolder, study: Study, segments: Sequence[Segment]
) -> tuple[tuple[Still, ...], str]:
    """Take stills from the videos that participants see.

    They show the first segment with videos of all conditions, or else of most, at the loudest
    syllable in each of `STILL_COUNT` equal parts of its speech. Conditions whose videos are missing
    or damaged have no stills.

    Returns
    -------
    stills : tuple of Still
        By condition, then moment.
    reason : str
        Why there are none, as a sentence; else empty.
    """
    keys = [(segment.name, name) for segment in segments for name in study.conditions]
    try:
        existing = stimulus_videos(folder, study, keys)
        videos = {key: existing[key].file for key in keys if key in existing}
        if not videos:
            return (), NO_VIDEOS
        chosen = max(segments, key=lambda segment: sum(name == segment.name for name, _ in videos))
        shown = {name: video for (segment, name), video in videos.items() if segment == chosen.name}
        first = next(iter(shown.values()))
        moments = [moment.seconds for moment in _moments(folder, chosen, first)]
    except InputError as error:
        return (), f"There are no stills of the conditions: {error.what}."
    stills: list[Still] = []
    for condition, video in shown.items():
        try:
            frames = frames_at(video, moments, STILL_PIXELS)
        except InputError:
            continue
        stills += [
            Still(
                condition=condition,
                segment=chosen.name,
                seconds=seconds,
                image=_data_url(frame),
            )
            for seconds, frame in zip(moments, frames, strict=True)
        ]
    return tuple(stills), "" if stills else "No video of a condition can be read."


def _moments(folder: StudyFolder, segment: Segment, video: Path) -> tuple[Moment, ...]:
    """Return the loudest moments of the speech, or even moments if it cannot be read."""
    try:
        speech = read_audio(folder.recording(segment)).cut(segment.start, segment.end)
    except InputError:
        return even_moments(video_duration(video), STILL_COUNT)
    return loud_moments(speech, STILL_COUNT)


def _data_url(frame: Image.Image) -> str:
    """Return a picture as a data URL."""
    data = io.BytesIO()
    frame.save(data, "WEBP", quality=_QUALITY, method=4)
    return "data:image/webp;base64," + base64.b64encode(data.getvalue()).decode()


def frames_at(video: Path, moments: Sequence[float], side: int) -> tuple[Image.Image, ...]:
    """Return downscaled frames of a video at some moments.

    Parameters
    ----------
    video : Path
        Any video that FFmpeg reads.
    moments : sequence of float
        Seconds from the start, ascending; after the end, the last frame is used.
    side : int
        Pixels of the longer side.

    Raises
    ------
    InputError
        If it cannot be read as a video.
    """
    frames: list[Image.Image] = []
    with pictures_of(video) as stream:
        half = 0.5 / float(stream.average_rate or 30)
        reformatter = VideoReformatter()
        last = None
        for frame in stream.container.decode(stream):
            last = frame
            while len(frames) < len(moments) and (frame.time or 0) + half > moments[len(frames)]:
                frames.append(_small(reformatter, frame, side))
            if len(frames) == len(moments):
                break
        if last is None:
            raise ValueError("no frame")
        frames += [_small(reformatter, last, side)] * (len(moments) - len(frames))
    return tuple(frames)


def _small(reformatter: VideoReformatter, frame: VideoFrame, side: int) -> Image.Image:
    scale = side / max(frame.width, frame.height)
    size = max(2, round(frame.width * scale)), max(2, round(frame.height * scale))
    return Image.fromarray(small_picture(reformatter, frame, size))
