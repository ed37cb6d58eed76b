"""The report of a study, or of a table of answers from any platform."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from analysis.exclusions.rules import ExclusionRule
from analysis.report import KnownShare, ReportInputs, write_report
from analysis.results.report import analyse_table
from analysis.results.writing import write_table_report
from studyapp.definition.folder import StudyFolder
from studyapp.definition.protocols.pairwise import pairwise
from studyapp.rehearsal.record import read_truth
from studyapp.stages.answers import answers_to_report
from studyapp.stages.preflight import study_notes


def report(folder: StudyFolder) -> Path:
    """Write the report of `folder` and return its page.

    Real answers are used where there are any, else those of the rehearsal; they are never
    mixed, and the report says which it shows.
    """
    study = pairwise(folder.study(), folder.definition)
    segments = tuple(folder.segments())
    answers = answers_to_report(folder)
    shown = (*study.conditions, study.catch.condition)
    inputs = ReportInputs(
        title=study.title,
        origin=answers.origin,
        reference=study.reference,
        catch_reference=study.catch_against,
        catch_condition=study.catch.condition,
        conditions=tuple(study.conditions),
        questions={question.name: question.text for question in study.questions},
        max_failed_catch=study.catch.max_failed,
        max_failed_attention=study.attention.max_failed if study.attention.trials else None,
        responses=answers.responses,
        clips={
            name: {
                segment.name: folder.clip(name, segment.name)
                for segment in segments
                if folder.clip(name, segment.name).exists()
            }
            for name in shown
        },
        speech={
            segment.name: (folder.speech / segment.wav, segment.start, segment.end)
            for segment in segments
        },
        segments=segments,
        truth=_known_shares(folder) if answers.origin == "rehearsal" else None,
        notes=study_notes(study),
        frozen=study.freeze,
        presentations=study.count(segments).presentations,
        study_sessions=answers.opened(),
        completed=answers.completed(),
    )
    return write_report(inputs, folder.report)


def report_table(
    responses: Path,
    protocol: str,
    out: Path,
    *,
    max_catch_failures: int,
    margin: float | None,
    exclude: Sequence[ExclusionRule] = (),
) -> Path:
    """Write the report of a platform's table of answers into `out` and return its page.

    See `analyse_table`; it needs no study folder.
    """
    found = analyse_table(
        responses,
        protocol,
        max_catch_failures=max_catch_failures,
        margin=margin,
        exclude=exclude,
    )
    return write_table_report(found, out)


def _known_shares(folder: StudyFolder) -> dict[tuple[str, str], KnownShare]:
    """Return what the rehearsal's participants were given to prefer."""
    return {
        (known.about, known.question): KnownShare(
            share=known.value, on_these_segments=known.value_on_these_segments
        )
        for known in read_truth(folder.rehearsal_truth).expected
    }
