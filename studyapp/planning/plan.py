"""`motionjury plan`: how large a study must be to find what it looks for."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from analysis.planning.grid import Runner, Show
from analysis.planning.part import Opinions, Size
from analysis.planning.plan import Plan, Request, plan
from analysis.planning.power import Effort
from analysis.planning.writing import CELLS, write_plan
from motion.errors import InputError
from studyapp.planning.pilot import read_pilot
from studyapp.planning.planned_study import (
    PlannedStudy,
    excluded_by_default,
    has_segments,
    notes_of,
    planned_segments,
)
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
    pay: float | None,
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
    pay : float or None
        What one participant costs.
    """
    study = folder.study()
    segments = planned_segments(folder, study, items)
    pilot_opinions = None if pilot is None else read_pilot(pilot, study.protocol)
    excluded = excluded_by_default(study) if pilot_opinions is None else pilot_opinions.excluded
    # Of a study without speech, only what is asked for can be meant.
    stands = has_segments(folder, study) or len(items) == 1
    planned_size = study.arms[0].places, len(segments)
    participants = participants or tuple(planned_size[0] * n for n in TIMES_PARTICIPANTS)
    items = items or tuple(planned_size[1] * n for n in TIMES_ITEMS)
    planned = PlannedStudy(study=study, segments=segments, excluded=excluded)
    _refuse_huge(planned.size(1, max(items)), max(participants))
    stated = study.rehearsal.model_fields_set & {"participants_differ", "segments_differ"}
    source, opinions = "As the study file states" if stated else "Assumed", _opinions(study)
    request = Request(
        title=study.title,
        protocol=study.protocol,
        size=planned.size,
        participants=tuple(sorted(set(participants))),
        items=tuple(sorted(set(items))),
        effects=tuple(sorted(set(effects))),
        own=planned_size if stands else None,
        per_comparison=len(study.arms) > 1,
        opinions=opinions if pilot_opinions is None else pilot_opinions.opinions,
        source=source if pilot_opinions is None else pilot_opinions.source,
        excluded=excluded,
        pay=pay,
        effort=Effort(),
        minutes=MINUTES,
        seed=study.seed,
        notes=(*notes_of(study), *(pilot_opinions.notes if pilot_opinions is not None else ())),
    )
    out = folder.root / "plan"
    result = plan(request, Runner(folder=out / CELLS, processes=processes, show=show))
    write_plan(result, out)
    return result


def _opinions(study: Study) -> Opinions:
    """Return how opinions differ according to the study file."""
    return Opinions(
        participant_sd=study.rehearsal.participants_differ,
        item_sd=study.rehearsal.segments_differ,
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
