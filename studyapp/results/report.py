"""The report of a study."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import pandas as pd
from markupsafe import Markup

from analysis.answers.participants import LeftOut
from analysis.metrics.score_tables import metrics_document, score_table
from analysis.report import wording
from analysis.report.content import PlayableMotion, Subject
from analysis.report.page import TASKS, write_report
from analysis.report.sections.metric_table import SCORES
from analysis.results.against_people import metrics_against_people
from analysis.results.heterogeneity import PreferredPair, preferred_pairs
from analysis.results.known_values import match_values
from analysis.results.report import Settings, Source, TableReport, analyse_answers
from analysis.stats.multiple_testing import NOT_LOGGED, LooksBefore
from motion.files import harmless_frame, replacing, write_frame
from motion.segment import Segment
from renderer.viewer.page import MotionFigures, scripts, style
from studyapp.rehearsal.simulation.truth import read_truth
from studyapp.results.analysed_tasks import ANSWERS, AnalysedTask, analysed_tasks
from studyapp.results.answers import (
    answers_to_report,
    arm_by_session,
    arm_states,
    has_current_design,
    read_rehearsal,
)
from studyapp.results.looks import earlier_looks, record_look
from studyapp.results.report_subject import study_subject
from studyapp.results.stated_beforehand import change_notes, exclusions_of
from studyapp.results.stored_answers import Answers
from studyapp.stimuli.shown_motion import segment_scene, study_look
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def report(
    folder: StudyFolder,
    *,
    reason: str = "",
    rehearsal: bool = False,
    with_motion: bool = False,
    warn: Callable[[str], None] | None = None,
    on_step: Callable[[str], None] = lambda _step: None,
) -> Path:
    """Write the report of `folder` and return its page.

    Real answers are reported if there are any, else those of the rehearsal. They are never mixed,
    and the report says which it shows.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    reason : str
        The reason in the log of looks.
    rehearsal : bool
        Report the rehearsal, even if there are real answers.
    with_motion : bool
        Let readers play the most and least preferred pairs on the page.
    warn : callable, optional
        Called with what to know about an interim look, or about answers that were not found.
    on_step : callable
        Called with the name of the next step.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    on_step("reading answers and metrics")
    study = folder.study()
    segments = _segments(folder, study)
    answers = read_rehearsal(folder) if rehearsal else answers_to_report(folder)
    subject = study_subject(
        folder,
        study,
        segments,
        origin=answers.origin,
        notes=(
            *exclusions_of(study, answers).notes,
            *change_notes(study, answers.stated),
        ),
    )
    on_step("comparing conditions")
    looks = earlier_looks(study, answers)
    tables: list[bytes] = []
    reports: list[TableReport] = []
    tasks = analysed_tasks(study, answers)
    if with_motion:
        on_step("packing motion")
        subject = replace(subject, motion=_playable_pairs(folder, study, segments, tasks))
    known = read_truth(folder.rehearsal_truth) if answers.origin == "rehearsal" else None
    for task in tasks:
        tables.append(_with_exclusions(task.rows, task.left_out))
        results = task_report(
            study,
            task,
            answers,
            sha256=hashlib.sha256(tables[-1]).hexdigest(),
            looks=looks,
        )
        agreement = metrics_against_people(
            task.table, task.left_out.analysed, subject.metrics, subject.recorded
        )
        reports.append(replace(results, metrics_against_people=agreement))
    if known is not None:
        subject = replace(subject, truth=match_values(reports, known.expected))
    remark = record_look(folder, study, answers, way="report", reason=reason)
    if answers.origin != "participants" and not rehearsal and not folder.shared_answers.exists():
        shown = ", so the report shows the rehearsal" if answers.origin == "rehearsal" else ""
        remark = (
            f"No answers of participants were found{shown}. If the study is served with "
            "DATABASE_URL, set it here as well."
        )
    if remark and warn is not None:
        warn(remark)
    metrics: dict[str, object] = {}
    if subject.metrics is not None:
        metrics = {"metrics": metrics_document(subject.metrics, folder.root)}
    on_step("drawing figures and tables")
    page = write_report(
        reports[0],
        subject,
        folder.report,
        extra_keys={"study": _study_document(study, subject, answers)} | metrics,
        further_tasks=tuple(reports[1:]),
    )
    for number, (task_results, table) in enumerate(zip(reports, tables, strict=True)):
        prefix = f"{TASKS[task_results.protocol]}_" if number else ""
        with replacing(folder.report / "tables" / f"{prefix}{ANSWERS}") as draft:
            draft.write_bytes(table)
    if subject.metrics is not None:
        # The many scores of single clips are written by 'motionjury metrics'.
        scores = score_table(replace(subject.metrics, clips=()))
        write_frame(folder.report / "tables" / SCORES, scores)
    return page


def _playable_pairs(
    folder: StudyFolder, study: Study, segments: Sequence[Segment], tasks: Sequence[AnalysedTask]
) -> PlayableMotion:
    """Return the motion of the most and least preferred pairs, for the page.

    The pairs are those of the first task that compares conditions. A pair whose motion cannot be
    read is left out, with the reason: its video may be a finished one, or a file may be missing.
    """
    by_task = (preferred_pairs(task.table, task.left_out.analysed) for task in tasks)
    pairs = next(filter(None, by_task), ())
    if not pairs:
        return PlayableMotion(left_out=("Nobody has compared two conditions yet.",))
    by_name = {segment.name: segment for segment in segments}
    figures = MotionFigures(study_look(folder, study))
    playable: list[tuple[PreferredPair, Markup]] = []
    left_out: dict[str, None] = {}
    with wording.labelled(study.display_names):
        for pair in pairs:
            segment = by_name.get(pair.segment)
            if segment is None:
                left_out[f"Segment {pair.segment} is no longer in the study."] = None
                continue
            scene, missing = segment_scene(
                folder, study, segment, (pair.first, pair.second), speech=segment
            )
            for condition, reason in missing.items():
                sentence = f"{wording.condition(condition)}, segment {segment.name}: {reason}."
                left_out[f"Not playable: {sentence}"] = None
            if not missing:
                labels = {wording.condition(name): clip for name, clip in scene.clips.items()}
                playable.append((pair, figures.figure(replace(scene, clips=labels))))
    return PlayableMotion(
        pairs=tuple(playable),
        sources=figures.sources() if playable else "",
        scripts=scripts() if playable else (),
        style=style() if playable else "",
        left_out=tuple(left_out),
    )


def _segments(folder: StudyFolder, study: Study) -> tuple[Segment, ...]:
    """Return the study's segments; empty for a shared copy without videos and speech."""
    is_finished = all(condition.videos for condition in study.conditions.values())
    if is_finished and not folder.has_segments(study):
        return ()
    return folder.segments_of(study)


def _with_exclusions(rows: pd.DataFrame, left_out: LeftOut) -> bytes:
    """Return a table as CSV, with a column for the reason of exclusion."""
    excluded = [left_out.exclusions.get(name, "") for name in rows["participant"].tolist()]
    table = harmless_frame(rows.assign(excluded=excluded))
    return table.to_csv(index=False, lineterminator="\n").encode()


def _study_document(study: Study, subject: Subject, answers: Answers) -> dict[str, object]:
    """Return the part of `results.json` about the study and its reported versions."""
    versions: list[int] = []
    if answers.stored is not None:
        sessions = answers.stored.study_sessions
        present = sessions[has_current_design(sessions)]
        versions = sorted({int(version) for version in present["version"]})
    return {
        "name": study.name,
        "title": study.title,
        "protocol": study.protocol,
        "sha256": subject.study_sha256,
        "seed": study.seed,
        "origin": subject.origin,
        "labels": {
            name: condition.label for name, condition in study.conditions.items() if condition.label
        },
        "versions": versions,
    }


def task_report(
    study: Study,
    task: AnalysedTask,
    answers: Answers,
    *,
    sha256: str = "",
    looks: LooksBefore = NOT_LOGGED,
) -> TableReport:
    """Return the results of one task; `sha256` is of the written table of answers."""
    stored = answers.stored
    return analyse_answers(
        task.table,
        task.left_out,
        source=Source(file=ANSWERS, sha256=sha256, motionjury=metadata.version("motionjury")),
        settings=Settings(
            max_catch_failures=None, margin=study.margin, family=study.family or "all"
        ),
        arms=() if stored is None else arm_states(study, stored),
        arm_of={} if stored is None else arm_by_session(study, stored.study_sessions),
        screened_out={} if stored is None else stored.screened_out,
        looks=looks,
    )
