"""What the report of a study is about, beside its answers."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence

from analysis.measurement.presets import PRESETS, REPORT
from analysis.measurement.scores import StudyMetrics
from analysis.report.sections.metric import PAPER_OF
from analysis.report.subject import Excerpt, Origin, Subject
from motion.segment import Segment
from studyapp.rehearsal.record import read_truth
from studyapp.results.analysed_tasks import compared
from studyapp.results.metrics import measure_study
from studyapp.results.report_strips import study_stills
from studyapp.results.study_notes import study_notes
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.scales import STEPS
from studyapp.study.settings.study import GROUND_TRUTH, Study


def study_subject(
    folder: StudyFolder,
    study: Study,
    segments: Sequence[Segment],
    *,
    origin: Origin,
    notes: Sequence[str] = (),
) -> Subject:
    """Return what is known of a study beside its answers, metrics and stills included."""
    shown = study_stills(folder, study, segments)
    return Subject(
        title=study.title,
        origin=origin,
        protocol=study.protocol,
        conditions=compared(study),
        questions={question.name: question.text for question in study.questions},
        reference=_reference(study),
        recorded=GROUND_TRUTH if study.has_recording else None,
        generative={
            name: condition.generative
            for name, condition in study.conditions.items()
            if condition.generative is not None
        },
        broken=study.catch.condition if study.catch.trials else None,
        scale_labels=_scale_labels(study),
        excerpts={
            segment.name: Excerpt(
                emotion=segment.emotion,
                speaker=segment.speaker,
                transcript=segment.transcript,
                seconds=segment.duration,
            )
            for segment in segments
        },
        notes=(*study_notes(study), *notes),
        frozen=study.freeze,
        study_sha256=hashlib.sha256(folder.definition.read_bytes()).hexdigest(),
        seed=study.seed,
        truth=read_truth(folder.rehearsal_truth).expected if origin == "rehearsal" else (),
        metrics=_metrics(folder, study, segments),
        stills=shown.stills,
        no_stills=shown.reason,
    )


def _reference(study: Study) -> str | None:
    if isinstance(study, PairwiseStudy) and study.has_reference_arms:
        return study.reference
    return None


def _scale_labels(study: Study) -> Mapping[str, tuple[str, ...]]:
    """Return the labels of scales that have one for each answer."""
    if not isinstance(study, RatingStudy):
        return {}
    return {
        question.name: tuple(question.labels)
        for question in study.questions
        if len(question.values) == STEPS
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
    """Return what a report measures: the usual, and what the papers report that the study follows.

    These are the protocol's paper and those whose systems move in it.
    """
    systems = (condition.generator for condition in study.conditions.values())
    papers = (PAPER_OF[study.protocol], *(name for name in systems if name in PRESETS))
    return tuple(dict.fromkeys((REPORT, *(name for name in papers if name is not None))))
