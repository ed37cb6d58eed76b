"""The report of a study, or of a table of answers from any platform."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import metadata
from pathlib import Path
from typing import Any

import pandas as pd
from markupsafe import Markup

from analysis.answers.exclusion_rules import ExclusionRule
from analysis.answers.participants import LeftOut
from analysis.measurement.score_tables import metrics_document
from analysis.report import Subject, wording, write_report
from analysis.report.page import TASKS
from analysis.report.subject import PlayableMotion
from analysis.results.preferred_pairs import PreferredPair, preferred_pairs
from analysis.results.report import Settings, Source, TableReport, analyse_answers, analyse_table
from motion.files import harmless_frame, replacing
from motion.segment import Segment
from renderer.viewer.page import MotionFigures, scripts, style
from studyapp.results.analysed_tasks import ANSWERS, AnalysedTask, analysed_tasks, rules_of
from studyapp.results.answers import (
    answers_to_report,
    arm_of_each,
    arm_states,
    of_present_design,
    read_rehearsal,
)
from studyapp.results.looks import earlier_looks, note_way_out
from studyapp.results.report_subject import study_subject
from studyapp.results.stated_beforehand import notes_on
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
    on_step: Callable[[str], None] = lambda _what: None,
) -> Path:
    """Write the report of `folder` and return its page.

    Real answers are used where there are any, else those of the rehearsal; they are never
    mixed, and the report says which it shows.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    reason : str
        Why results are looked at, for the log of looks.
    rehearsal : bool
        Whether the rehearsal's answers are reported, though there are real ones.
    with_motion : bool
        Whether the most and least preferred pairs can be played on the page.
    warn : callable, optional
        Told, in sentences, what looking before the end means; nothing where it is the end.
    on_step : callable
        Called with what is done next.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    on_step("reading answers and metrics")
    study = folder.study()
    segments = _segments(folder, study)
    answers = read_rehearsal(folder) if rehearsal else answers_to_report(folder)
    before = answers.stated
    subject = study_subject(
        folder,
        study,
        segments,
        origin=answers.origin,
        notes=(
            *rules_of(study, answers).notes,
            *notes_on("margin", study, before),
            *notes_on("family", study, before),
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
    for task in tasks:
        tables.append(_with_exclusions(task.rows, task.left_out))
        reports.append(
            task_report(
                study,
                task,
                answers,
                sha256=hashlib.sha256(tables[-1]).hexdigest(),
                settings=Settings(
                    max_catch_failures=None, margin=study.margin, family=study.family or "all"
                ),
                metrics=subject.metrics,
                recorded=subject.recorded,
                looks=looks,
            )
        )
    remark = note_way_out(folder, study, answers, way="report", reason=reason)
    if remark and warn is not None:
        warn(remark)
    on_step("drawing figures and tables")
    page = write_report(
        reports[0],
        subject,
        folder.report,
        extra_keys={"study": _of_study(study, subject, answers)} | _metrics(subject, folder),
        further_tasks=tuple(reports[1:]),
    )
    for number, (each, table) in enumerate(zip(reports, tables, strict=True)):
        own = f"{TASKS[each.protocol]}_" if number else ""
        with replacing(folder.report / "tables" / f"{own}{ANSWERS}") as draft:
            draft.write_bytes(table)
    return page


def _playable_pairs(
    folder: StudyFolder, study: Study, segments: Sequence[Segment], tasks: Sequence[AnalysedTask]
) -> PlayableMotion:
    """Return the most and least preferred pairs of a study, as its report plays them.

    A pair of which a motion cannot be read is left out, with the reason: it may be a video that
    was brought finished, or a file that is gone since.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    study : Study
        Its definition.
    segments : sequence of Segment
        Its speech.
    tasks : sequence of AnalysedTask
        Its answers; the pairs are those of the first task that compares conditions.
    """
    found = (preferred_pairs(task.table, task.left_out.analysed) for task in tasks)
    pairs = next((one for one in found if one), ())
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
                left_out[f"Segment {pair.segment} is not in the study any more."] = None
                continue
            scene, missing = segment_scene(
                folder, study, segment, (pair.first, pair.second), speech=segment
            )
            for condition, why in missing.items():
                sentence = f"{wording.condition(condition)}, segment {segment.name}: {why}."
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


def _metrics(subject: Subject, folder: StudyFolder) -> dict[str, object]:
    """Return what `results.json` says of automatic metrics; nothing where there are none."""
    if subject.metrics is None:
        return {}
    return {"metrics": metrics_document(subject.metrics, folder.root)}


def _segments(folder: StudyFolder, study: Study) -> tuple[Segment, ...]:
    """Return the study's segments; none of a shared copy without its videos and speech."""
    is_finished = all(condition.videos for condition in study.conditions.values())
    has_speech = (folder.speech / "segments.csv").exists()
    if is_finished and not has_speech and not any(folder.videos.glob("*/*.mp4")):
        return ()
    return tuple(folder.segments_of(study))


def report_table(
    responses: Path,
    protocol: str,
    out: Path,
    *,
    max_catch_failures: int,
    margin: float | None,
    family: str = "all",
    scale: tuple[int, int] | None = None,
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
        family=family,
        scale=scale,
        exclude=exclude,
    )
    subject = Subject(
        title=f"Answers in {responses.name}",
        origin="table",
        protocol=protocol,
        conditions=found.conditions_shown,
        questions=dict.fromkeys(found.questions, ""),
    )
    return write_report(found, subject, out)


def _with_exclusions(rows: pd.DataFrame, left_out: LeftOut) -> bytes:
    """Return a table as a CSV file that says who is left out and why."""
    excluded = [left_out.exclusions.get(who, "") for who in rows["participant"].tolist()]
    table = harmless_frame(rows.assign(excluded=excluded))
    return table.to_csv(index=False, lineterminator="\n").encode()


def _of_study(study: Study, subject: Subject, answers: Answers) -> dict[str, object]:
    """Return what `results.json` says of the study, and which versions of it are reported."""
    versions: list[int] = []
    if answers.stored is not None:
        sessions = answers.stored.study_sessions
        present = sessions[of_present_design(sessions)]
        versions = sorted({int(version) for version in present["version"]})
    return {
        "name": study.name,
        "title": study.title,
        "protocol": study.protocol,
        "sha256": subject.study_sha256,
        "seed": study.seed,
        "origin": subject.origin,
        "labels": {name: made.label for name, made in study.conditions.items() if made.label},
        "versions": versions,
    }


def task_report(
    study: Study,
    task: AnalysedTask,
    answers: Answers,
    *,
    settings: Settings,
    sha256: str = "",
    **more: Any,
) -> TableReport:
    """Return the results of one task.

    Parameters
    ----------
    sha256 : str
        Of the table of its answers, where that is written.
    **more
        As for `analysis.results.report.analyse_answers`.
    """
    stored = answers.stored
    return analyse_answers(
        task.table,
        task.left_out,
        source=Source(file=ANSWERS, sha256=sha256, motionjury=metadata.version("motionjury")),
        settings=settings,
        arms=() if stored is None else arm_states(study, stored),
        arm_of={} if stored is None else arm_of_each(study, stored.study_sessions),
        screened_out={} if stored is None else stored.screened_out,
        **more,
    )
