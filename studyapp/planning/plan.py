"""`motionjury plan`: how large a study must be."""

from collections.abc import Callable
from typing import Final

from analysis.planning.part import Opinions
from analysis.planning.plan import Plan, Request, plan
from analysis.planning.writing import write_plan
from studyapp.planning.planned_study import (
    PlannedStudy,
    excluded_by_default,
    notes_of,
    planned_segments,
)
from studyapp.study.folder import StudyFolder

TIMES_PARTICIPANTS: Final = (1, 2, 4, 8)
TIMES_ITEMS: Final = (1, 2)
"""Multiples of the study's own numbers that are tried by default."""


def plan_study(
    folder: StudyFolder,
    *,
    participants: tuple[int, ...],
    items: tuple[int, ...],
    effects: tuple[float, ...],
    show: Callable[[int, int], None] | None = None,
) -> Plan:
    """Simulate the study of `folder` in several sizes, and write what it finds into its folder.

    Where an argument is empty, the study's own setting is used.

    Parameters
    ----------
    participants, items : tuple of int
        Numbers that are tried.
    effects : tuple of float
        Differences, in logits.
    show : callable, optional
        Called with the numbers of finished and of all cells.
    """
    study = folder.study()
    segments = planned_segments(folder, study, items)
    own_size = study.arms[0].places, len(segments)
    participants = participants or tuple(own_size[0] * n for n in TIMES_PARTICIPANTS)
    # A study without speech has no size of its own, unless one number of segments is asked for.
    has_own_size = folder.has_segments(study) or len(items) == 1
    items = items or tuple(own_size[1] * n for n in TIMES_ITEMS)
    planned = PlannedStudy(study=study, segments=segments, excluded=excluded_by_default(study))
    stated = study.rehearsal.model_fields_set & {"participants_differ", "segments_differ"}
    request = Request(
        size=planned.size,
        participants=tuple(sorted(set(participants))),
        items=tuple(sorted(set(items))),
        effects=tuple(sorted(set(effects))),
        current=own_size if has_own_size else None,
        per_comparison=len(study.arms) > 1,
        opinions=Opinions(
            participant_sd=study.rehearsal.participants_differ,
            item_sd=study.rehearsal.segments_differ,
        ),
        source="As the study file states" if stated else "Assumed",
        excluded=planned.excluded,
        seed=study.seed,
        notes=notes_of(study),
    )
    result = plan(request, show)
    write_plan(result, folder.root / "plan")
    return result
