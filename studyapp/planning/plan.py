"""`motionjury plan`: how large a study must be to find what it looks for."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

from analysis.planning.grid import FEWEST_QUICK, Runner, Show
from analysis.planning.part import Opinions, Size, Sketch, Test
from analysis.planning.plan import Plan, Request, plan
from analysis.planning.power import FEWEST_EXACT, Effort
from analysis.planning.writing import CELLS, write_plan
from motion.errors import InputError
from studyapp.planning.pilot import Pilot, read_pilot
from studyapp.planning.planned_study import (
    PlannedStudy,
    excluded_by_default,
    has_segments,
    notes_of,
    own_participants,
    planned_segments,
    with_trials,
)
from studyapp.study.folder import StudyFolder

SKETCHES: Final[Mapping[str, Sketch]] = MappingProxyType(
    {
        "pairwise": Sketch(kind="pairs"),
        "rating": Sketch(kind="ratings", conditions=3),
        "ranking": Sketch(kind="rankings", conditions=3),
        "mismatch": Sketch(kind="pairs", levels=3),
    }
)
"""The plainest study of each protocol, which is planned where there is no study file."""

MINUTES: Final = 2.0
"""About how long a plan may take on two processors where no precision is asked for."""

SEED: Final = 1
"""Of a study that has no file."""

TIMES_PARTICIPANTS: Final = (1, 2, 4, 8)
TIMES_ITEMS: Final = (1, 2)
"""How many times the study's own numbers are tried unless told otherwise."""

MOST_ANSWERS: Final = 400_000
"""Answers to one question in one simulated study, at most."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """What the command line asks for; what is None or empty is for the study to say.

    Attributes
    ----------
    participants, items : tuple of int
        Numbers that are tried.
    effects : tuple of float
        Differences, in logits.
    trials : int or None
        Trials of each participant; 0 for one of each item.
    pilot : Path or None
        A finished study, or a table of answers, whose spreads are taken.
    pay : float or None
        What one participant costs.
    test : {'report', 'crossed_lmm'}
        What decides.
    precision : float or None
        Monte-Carlo standard error of each power; None for what `MINUTES` allow.
    """

    participants: tuple[int, ...]
    items: tuple[int, ...]
    effects: tuple[float, ...]
    trials: int | None
    pilot: Path | None
    pay: float | None
    test: Test
    precision: float | None


def plan_study(
    folder: StudyFolder,
    options: Options,
    out: Path,
    *,
    processes: int = 1,
    show: Show | None = None,
) -> Plan:
    """Simulate the study of `folder` in several sizes, and write what it finds into `out`."""
    study = folder.study()
    segments = planned_segments(folder, study, options.items)
    if options.trials is not None:
        study = with_trials(study, options.trials or max(options.items or (len(segments),)))
    pilot = _pilot(options, study.protocol)
    excluded = excluded_by_default(study) if pilot is None else pilot.excluded
    stated = study.rehearsal.model_fields_set & {"participants_differ", "segments_differ"}
    own = own_participants(study), len(segments)
    # Of a study without speech, only what is asked for can be meant.
    as_it_stands = own if has_segments(folder, study) or len(options.items) == 1 else None
    planned = PlannedStudy(study=study, segments=segments, test=options.test, excluded=excluded)
    return _planned(
        options,
        pilot,
        out,
        title=study.title,
        protocol=study.protocol,
        size=planned.size,
        participants=options.participants or tuple(own[0] * n for n in TIMES_PARTICIPANTS),
        items=options.items or tuple(own[1] * n for n in TIMES_ITEMS),
        own=as_it_stands,
        per_comparison=len(study.arms) > 1,
        opinions=Opinions(
            participant_sd=study.rehearsal.participants_differ,
            item_sd=study.rehearsal.segments_differ,
        ),
        source="As the study file states" if stated else "Assumed",
        excluded=excluded,
        seed=study.seed,
        notes=notes_of(study),
        processes=processes,
        show=show,
    )


def plan_sketch(
    protocol: str,
    options: Options,
    out: Path,
    *,
    processes: int = 1,
    show: Show | None = None,
) -> Plan:
    """Simulate a study that has no file yet, and write what it finds into `out`."""
    pilot = _pilot(options, protocol)
    excluded = 0.0 if pilot is None else pilot.excluded
    sketch = replace(SKETCHES[protocol], trials=options.trials or None, test=options.test)
    return _planned(
        options,
        pilot,
        out,
        title=f"A {protocol} study",
        protocol=protocol,
        size=lambda participants, items: sketch.size(participants, items, excluded=excluded),
        participants=options.participants,
        items=options.items,
        own=None,
        per_comparison=False,
        opinions=Opinions(),
        source="Assumed",
        excluded=excluded,
        seed=SEED,
        notes=(),
        processes=processes,
        show=show,
    )


def _planned(
    options: Options,
    pilot: Pilot | None,
    out: Path,
    *,
    title: str,
    protocol: str,
    size: Callable[[int, int], Size],
    participants: Sequence[int],
    items: Sequence[int],
    own: tuple[int, int] | None,
    per_comparison: bool,
    opinions: Opinions,
    source: str,
    excluded: float,
    seed: int,
    notes: tuple[str, ...],
    processes: int,
    show: Show | None,
) -> Plan:
    _refuse_huge(size(1, max(items)), max(participants))
    request = Request(
        title=title,
        protocol=protocol,
        size=size,
        participants=tuple(sorted(set(participants))),
        items=tuple(sorted(set(items))),
        effects=tuple(sorted(set(options.effects))),
        own=own,
        per_comparison=per_comparison,
        opinions=opinions if pilot is None else pilot.opinions,
        source=source if pilot is None else pilot.source,
        excluded=excluded,
        pay=options.pay,
        effort=_effort(options.precision or Effort.precision),
        minutes=MINUTES if options.precision is None else math.inf,
        seed=seed,
        notes=(*notes, *(pilot.notes if pilot is not None else ())),
    )
    found = plan(request, Runner(folder=out / CELLS, processes=processes, show=show))
    write_plan(found, out)
    return found


def _effort(precision: float) -> Effort:
    """Return how much is simulated at most for a precision."""
    times = (Effort.precision / precision) ** 2
    return Effort(
        quick=max(FEWEST_QUICK, int(Effort.quick * times)),
        exact=max(FEWEST_EXACT, int(Effort.exact * times)),
        precision=precision,
    )


def _pilot(options: Options, protocol: str) -> Pilot | None:
    return None if options.pilot is None else read_pilot(options.pilot, protocol)


def _refuse_huge(alone: Size, participants: int) -> None:
    """Refuse what one computer cannot hold, before it is drawn up.

    Parameters
    ----------
    alone : Size
        The study of one participant.
    """
    if alone.trials * participants > MOST_ANSWERS:
        raise InputError(
            f"{participants:,} participants with {alone.trials:,} trials each give more than "
            f"{MOST_ANSWERS:,} answers to one question",
            remedy="Plan fewer; the powers of larger studies are hardly higher, since segments "
            "limit them",
        )
