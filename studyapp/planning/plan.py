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
from studyapp.planning.pilot import Assumptions, read_pilot
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
    assumed = _assumptions(study) if pilot is None else read_pilot(pilot, study.protocol)
    own_size = study.arms[0].places, len(segments)
    participants = participants or tuple(own_size[0] * n for n in TIMES_PARTICIPANTS)
    # A study without speech has no size of its own, unless one number of segments is asked for.
    has_own_size = has_segments(folder, study) or len(items) == 1
    items = items or tuple(own_size[1] * n for n in TIMES_ITEMS)
    planned = PlannedStudy(study=study, segments=segments, excluded=assumed.excluded)
    _refuse_huge(planned.size(1, max(items)), max(participants))
    request = Request(
        title=study.title,
        protocol=study.protocol,
        size=planned.size,
        participants=tuple(sorted(set(participants))),
        items=tuple(sorted(set(items))),
        effects=tuple(sorted(set(effects))),
        own=own_size if has_own_size else None,
        per_comparison=len(study.arms) > 1,
        opinions=assumed.opinions,
        source=assumed.source,
        excluded=assumed.excluded,
        pay=pay,
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
