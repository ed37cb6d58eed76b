"""`motionjury plan`: how large a study must be to find what it looks for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from analysis.planning.grid import FEWEST_QUICK, Runner, Show
from analysis.planning.part import Opinions, Test
from analysis.planning.plan import Plan, Request, plan
from analysis.planning.power import FEWEST_EXACT, Effort
from analysis.planning.size import Size, Sketch
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

EFFECTS: Final = (0.2, 0.4, 0.6)
"""Differences that are looked for unless told otherwise, in logits."""

TIMES_PARTICIPANTS: Final = (1, 2, 4, 8)
TIMES_ITEMS: Final = (1, 2)
"""How many times the study's own numbers are tried unless told otherwise."""

MOST_ANSWERS: Final = 400_000
"""Answers to one question in one simulated study, at most."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """What the command line asks for; what is None is for the study, or a default, to say.

    Attributes
    ----------
    participants, items : tuple of int
        Numbers that are tried.
    effects : tuple of float
        Differences, in logits.
    trials : int or None
        Trials of each participant; 0 for one of each item.
    participant_sd, item_sd : float or None
        How much the difference of two conditions varies, in logits.
    excluded : float or None
        Share of participants who will be left out.
    pilot : Path or None
        A finished study, or a table of answers, whose spreads are taken.
    pay : float or None
        What one participant costs.
    test : {'report', 'crossed_lmm'}
        What decides.
    precision : float
        Monte-Carlo standard error of each power.
    minutes : float
        About how long it may take, on two processors.
    seed : int
        The same seed gives the same numbers.
    """

    participants: tuple[int, ...] = ()
    items: tuple[int, ...] = ()
    effects: tuple[float, ...] = ()
    trials: int | None = None
    participant_sd: float | None = None
    item_sd: float | None = None
    excluded: float | None = None
    pilot: Path | None = None
    pay: float | None = None
    test: Test = "report"
    precision: float = Effort.precision
    minutes: float = 2.0
    seed: int = 1


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
    excluded = _excluded(options, pilot, excluded_by_default(study))
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
        excluded=excluded,
        notes=notes_of(study),
        processes=processes,
        show=show,
    )


def plan_sketch(
    protocol: str,
    sketch: Sketch,
    options: Options,
    out: Path,
    *,
    processes: int = 1,
    show: Show | None = None,
) -> Plan:
    """Simulate a study that has no file yet, and write what it finds into `out`."""
    pilot = _pilot(options, protocol)
    excluded = _excluded(options, pilot, 0.0)
    chosen = replace(sketch, trials=options.trials or None, test=options.test)
    return _planned(
        options,
        pilot,
        out,
        title=f"A {protocol} study",
        protocol=protocol,
        size=lambda participants, items: chosen.size(participants, items, excluded=excluded),
        participants=options.participants,
        items=options.items,
        own=None,
        per_comparison=sketch.own_participants and sketch.comparisons > 1,
        excluded=excluded,
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
    excluded: float,
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
        effects=tuple(sorted(set(options.effects or EFFECTS))),
        own=own,
        per_comparison=per_comparison,
        opinions=_opinions(options, pilot),
        source=_source(options, pilot),
        excluded=excluded,
        pay=options.pay,
        effort=_effort(options.precision),
        minutes=options.minutes,
        seed=options.seed,
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


def _opinions(options: Options, pilot: Pilot | None) -> Opinions:
    found = Opinions() if pilot is None else pilot.opinions
    if options.participant_sd is not None:
        found = replace(found, participant_sd=options.participant_sd)
    if options.item_sd is not None:
        found = replace(found, item_sd=options.item_sd)
    return found


def _source(options: Options, pilot: Pilot | None) -> str:
    given = [options.participant_sd is not None, options.item_sd is not None]
    if pilot is None or all(given):
        return "As told" if all(given) else "Assumed"
    return f"{pilot.source}{', one of the two as told' if any(given) else ''}"


def _excluded(options: Options, pilot: Pilot | None, default: float) -> float:
    if options.excluded is not None:
        return options.excluded
    return default if pilot is None else pilot.excluded


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
