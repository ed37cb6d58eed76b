"""What a plan takes from a pilot: how much opinions differ, and the share that is excluded."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analysis.answers.participants import LeftOut, leave_out, table_rules
from analysis.answers.reading import read_answers
from analysis.answers.table import LAYOUTS, AnswerTable
from analysis.planning.part import Opinions
from analysis.planning.pilot_spreads import pilot_opinions
from motion.errors import InputError
from studyapp.results.analysed_tasks import analysed_tasks
from studyapp.results.answers import answers_to_report
from studyapp.study.folder import StudyFolder

ROUGH: Final = 10
"""Participants or segments below which spreads are rough."""


@dataclass(frozen=True, kw_only=True)
class Assumptions:
    """What a plan assumes about participants, estimated from a pilot or not.

    Attributes
    ----------
    opinions : Opinions
        How people answer.
    excluded : float
        Share of participants who are excluded.
    source : str
        Where the assumptions come from, in words.
    notes : tuple of str
        What limits them, as sentences.
    """

    opinions: Opinions
    excluded: float
    source: str
    notes: tuple[str, ...] = ()


def read_pilot(path: Path, protocol: str) -> Assumptions:
    """Read a pilot: the folder of a study that was answered, or a table of answers.

    Parameters
    ----------
    path : Path
        A study folder, or a CSV or Parquet file as ``motionjury report --responses`` takes it.
    protocol : {'pairwise', 'rating', 'ranking', 'mismatch'}
        Of the study that is planned; the pilot's must be the same.

    Raises
    ------
    InputError
        If it cannot be read, or tells nothing.
    """
    rehearsed = False
    if path.is_dir():
        table, left_out, rehearsed = _of_study(StudyFolder(path), protocol)
    else:
        table = read_answers(path, LAYOUTS[protocol])
        left_out = leave_out(table, table_rules(table))
    if left_out.analysed.empty:
        raise InputError(
            "the pilot has no answers that are analysed",
            where=path,
            remedy="Name a study that was answered, or leave --pilot away",
        )
    opinions, answers = pilot_opinions(table, left_out.analysed)
    groups = {name: int(left_out.analysed[name].nunique()) for name in ("participant", "segment")}
    few = [f"{count} {name}s" for name, count in groups.items() if count < ROUGH]
    notes = []
    if few:
        notes.append(
            f"The pilot has {' and '.join(few)}: its spreads are rough. Plan without it as well, "
            "and with larger ones (rehearsal.participants_differ, rehearsal.segments_differ)."
        )
    if rehearsed:
        notes.append("The pilot was answered by simulated raters: it tells nothing about people.")
    return Assumptions(
        opinions=opinions,
        excluded=1 - left_out.attentive / left_out.recruited,
        source=f"Estimated from {answers:,} answers of {groups['participant']} participants about "
        f"{groups['segment']} segments in {path.name or path}",
        notes=tuple(notes),
    )


def _of_study(folder: StudyFolder, protocol: str) -> tuple[AnswerTable, LeftOut, bool]:
    study = folder.study()
    if study.protocol != protocol:
        raise InputError(
            f"the pilot is a {study.protocol} study, and a {protocol} study is planned",
            where=folder.root,
            remedy="Name a pilot of the same protocol",
        )
    answers = answers_to_report(folder)
    if answers.stored is None:
        raise InputError(
            "nobody has answered the pilot",
            where=folder.root,
            remedy="Name a study that was answered, or leave --pilot away",
        )
    tasks = analysed_tasks(study, answers)
    task = next((task for task in tasks if task.protocol == protocol), None)
    if task is None:
        raise InputError(
            f"the pilot has no answers to a {protocol} task",
            where=folder.root,
            remedy="Name a study that was answered, or leave --pilot away",
        )
    return task.table, task.left_out, answers.origin == "rehearsal"
