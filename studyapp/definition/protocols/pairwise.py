"""The trials of one participant: order, sides, practice, repeats and catch trials.

After AMUSE (Chhatre et al. 2024, section 5.3 and appendix H): the first trials are discarded and
shown again at the end, sides are random, and catch trials are scattered among the others. What
the paper leaves open is decided here:

- Sides are random but balanced within the participant: of the analysed trials (main and repeat)
  half show the reference on the left, and an odd one falls to either side by chance. Practice
  and catch trials are balanced each among themselves.
- A repeat draws its side anew, so that an answer cannot be given from the memory of a side.
- A catch trial is never among the practice trials and never the first trial; two of them do not
  follow each other as long as there are enough places between the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from motion.segment import Segment
from studyapp.definition.study import Study, comparison_name
from studyapp.design.allocation import allocate_segments, shuffled
from studyapp.design.planned_trial import Kind, PlannedTrial
from studyapp.design.trial_count import planned_trials


def participant_trials(
    study: Study, segments: Sequence[Segment], *, other: str, number: int
) -> tuple[PlannedTrial, ...]:
    """Return the trials of one place of a comparison, in the order they are shown.

    Parameters
    ----------
    study : Study
        Its seed decides everything together with `other` and `number`.
    segments : sequence of Segment
        All segments of the study.
    other : str
        The condition compared with the study's reference.
    number : int
        The place's number within the comparison, from 0.

    Returns
    -------
    tuple of PlannedTrial
        Practice, then main with catch trials among them, then the repeats.
    """
    count = planned_trials(study, segments)
    comparison = (study.seed, *comparison_name(study.reference, other).encode())
    chance = np.random.default_rng([number + 1, *comparison])
    chosen = shuffled(
        allocate_segments(segments, study.trials, number=number, seed=comparison), chance
    )
    first, rest = chosen[: count.practice], chosen[count.practice :]
    pair = (study.reference, other)
    practice = _pairs("practice", first, pair, chance)
    analysed = _pairs("main", [*rest, *first], pair, chance)
    main, repeats = analysed[: count.main], analysed[count.main :]
    repeats = [
        replace(trial, kind="repeat", repeats=position)
        for position, trial in enumerate(repeats, start=1)
    ]
    catch = _catch_trials(study, segments, chance)
    later = _scattered(catch, [*main, *repeats], chance, may_lead=bool(practice))
    return tuple(
        replace(trial, position=position)
        for position, trial in enumerate([*practice, *later], start=1)
    )


def _pairs(
    kind: Kind, segments: Sequence[Segment], pair: tuple[str, str], chance: np.random.Generator
) -> list[PlannedTrial]:
    """Return one trial per segment, with `pair` one way round in half of them."""
    a, b = pair
    return [
        PlannedTrial(
            position=0,
            kind=kind,
            segment=segment,
            left=a if first_is_left else b,
            right=b if first_is_left else a,
        )
        for segment, first_is_left in zip(segments, _sides(len(segments), chance), strict=True)
    ]


def _sides(count: int, chance: np.random.Generator) -> list[bool]:
    """Return `count` random sides, half of them True; an odd one is either by chance."""
    start = int(chance.integers(2))
    return shuffled([bool((start + index) % 2) for index in range(count)], chance)


def _catch_trials(
    study: Study, segments: Sequence[Segment], chance: np.random.Generator
) -> list[PlannedTrial]:
    """Return the catch trials; a segment comes twice only when there are too few."""
    heard: list[Segment] = []
    while segments and len(heard) < study.catch.trials:
        heard.extend(shuffled(segments, chance))
    heard = heard[: study.catch.trials]
    trials = _pairs("catch", heard, (study.catch_against, study.catch.condition), chance)
    return [
        replace(trial, expected="left" if trial.left == study.catch_against else "right")
        for trial in trials
    ]


def _scattered(
    catch: Sequence[PlannedTrial],
    others: Sequence[PlannedTrial],
    chance: np.random.Generator,
    *,
    may_lead: bool,
) -> list[PlannedTrial]:
    """Return `others` in their order with `catch` put into random gaps between them."""
    gaps = np.arange(0 if may_lead else 1, len(others) + 1)
    enough = len(gaps) >= len(catch)
    before = sorted(chance.choice(gaps, size=len(catch), replace=not enough).tolist())
    merged = list(others)
    for gap, trial in sorted(zip(before, catch, strict=True), key=lambda at: at[0], reverse=True):
        merged.insert(gap, trial)
    return merged
