"""`motionjury plan`: how large a study must be, by what is assumed or a pilot tells of people."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analysis.answers.participants import LeftOut, leave_out, table_rules
from analysis.answers.reading import read_answers
from analysis.answers.table import LAYOUTS, AnswerTable
from analysis.planning.grid import Runner, Show
from analysis.planning.part import Opinions, Size
from analysis.planning.pilot_spreads import pilot_opinions
from analysis.planning.plan import Plan, Request, plan
from analysis.planning.power import Effort
from analysis.planning.writing import CELLS, write_plan
from motion.errors import InputError
from studyapp.planning.planned_study import (
    PlannedStudy,
    excluded_by_default,
    notes_of,
    planned_segments,
)
from studyapp.results.analysed_tasks import analysed_tasks
from studyapp.results.answers import answers_to_report
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study

MINUTES: Final = 2.0
"""About how long a plan may take on two processors."""

TIMES_PARTICIPANTS: Final = (1, 2, 4, 8)
TIMES_ITEMS: Final = (1, 2)
"""Multiples of the study's own numbers that are tried by default."""

MOST_ANSWERS: Final = 400_000
"""Answers to one question in one simulated study, at most."""


def plan_study(
    folder: StudyFolder,
    *,
    participants: tuple[int, ...],
    items: tuple[int, ...],
    effects: tuple[float, ...],
    pilot: Path | None,
    processes: int = 1,
    show: Show | None = None,
) -> Plan:
    """Simulate the study of `folder` in several sizes, and write what it finds into its folder.

    Where an argument is None or empty, the study's own setting is used.

    Parameters
    ----------
    participants, items : tuple of int
        Numbers that are tried.
    effects : tuple of float
        Differences, in logits.
    pilot : Path or None
        A finished study, or a table of answers, whose spreads are taken.
    """
    study = folder.study()
    segments = planned_segments(folder, study, items)
    assumed = _assumptions(study) if pilot is None else read_pilot(pilot, study.protocol)
    own_size = study.arms[0].places, len(segments)
    participants = participants or tuple(own_size[0] * n for n in TIMES_PARTICIPANTS)
    # A study without speech has no size of its own, unless one number of segments is asked for.
    has_own_size = folder.has_segments(study) or len(items) == 1
    items = items or tuple(own_size[1] * n for n in TIMES_ITEMS)
    planned = PlannedStudy(study=study, segments=segments, excluded=assumed.excluded)
    _refuse_huge(planned.size(1, max(items)), max(participants))
    request = Request(
        size=planned.size,
        participants=tuple(sorted(set(participants))),
        items=tuple(sorted(set(items))),
        effects=tuple(sorted(set(effects))),
        current=own_size if has_own_size else None,
        per_comparison=len(study.arms) > 1,
        opinions=assumed.opinions,
        source=assumed.source,
        excluded=assumed.excluded,
        effort=Effort(),
        minutes=MINUTES,
        seed=study.seed,
        notes=(*notes_of(study), *assumed.notes),
    )
    out = folder.root / "plan"
    result = plan(request, Runner(folder=out / CELLS, processes=processes, show=show))
    write_plan(result, out)
    return result


def _assumptions(study: Study) -> Assumptions:
    """Return what is assumed without a pilot: what the study file states, or the defaults."""
    stated = study.rehearsal.model_fields_set & {"participants_differ", "segments_differ"}
    return Assumptions(
        opinions=Opinions(
            participant_sd=study.rehearsal.participants_differ,
            item_sd=study.rehearsal.segments_differ,
        ),
        excluded=excluded_by_default(study),
        source="As the study file states" if stated else "Assumed",
    )


def _refuse_huge(one_participant: Size, participants: int) -> None:
    """Refuse a study that does not fit into memory, before it is drawn up.

    Parameters
    ----------
    one_participant : Size
        The study of one participant.
    """
    if one_participant.trials * participants > MOST_ANSWERS:
        raise InputError(
            f"{participants:,} participants with {one_participant.trials:,} trials each give more "
            f"than {MOST_ANSWERS:,} answers to one question",
            remedy="Plan fewer; the powers of larger studies are hardly higher, since segments "
            "limit them",
        )


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
        Protocol of the study that is planned; the pilot's must be the same.

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
        raise _no_answers(path, protocol)
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
    tasks = analysed_tasks(study, answers)
    task = next((task for task in tasks if task.protocol == protocol), None)
    if task is None:
        raise _no_answers(folder.root, protocol)
    return task.table, task.left_out, answers.origin == "rehearsal"


def _no_answers(pilot: Path, protocol: str) -> InputError:
    return InputError(
        f"the pilot has no answers to a {protocol} task that are analysed",
        where=pilot,
        remedy="Name a study that was answered, or leave --pilot away",
    )
