"""What of a study's planned trials a plan simulates: the blocks of tests that its report has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from analysis.planning.part import Kind, Part, Test, Trials
from studyapp.study.design.planned_trial import PlannedTrial
from studyapp.study.protocols.mismatch import FIT, MismatchStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study

Shown = Sequence[tuple[int, PlannedTrial]]
"""Who is shown which trials."""

_KINDS: Final[Mapping[str, Kind]] = {"rating": "ratings", "ranking": "rankings"}


def planned_parts(
    study: Study, shown: Shown, of_segment: Mapping[str, int], test: Test
) -> Iterator[Part]:
    """Yield the parts of a study, and those questions of a part apart that have other scales.

    Parameters
    ----------
    study : Study
        Whose trials they are.
    shown : sequence of (int, PlannedTrial)
        The analysed trials of one arm, with the number of the participant.
    of_segment : mapping of str to int
        Numbers of the segments.
    test : {'report', 'crossed_lmm'}
        What decides.
    """
    for name in study.parts or ("",):
        own = [(who, trial) for who, trial in shown if trial.part == name]
        trials, alike = _trials(study, name, own, of_segment)
        scales = _scales(study, name)
        for levels, questions in scales.items():
            yield Part(
                name=name if len(scales) == 1 else f"{name} ({levels} levels)".strip(),
                kind=_KINDS.get(study.protocol, "pairs"),
                trials=trials,
                levels=levels,
                blocks=questions * alike,
                family=name if isinstance(study, MismatchStudy) else "",
                test=test,
            )


def _scales(study: Study, part: str) -> dict[int, int]:
    """Return how many questions of a part have how many levels."""
    levels = {question.name: 5 for question in study.questions}
    if isinstance(study, RatingStudy):
        levels = {question.name: len(question.values) for question in study.questions}
    if isinstance(study, MismatchStudy):
        levels = {question.name: question.levels for question in study.questions}
    return Counter(levels[each.name] for each in study.questions if each.belongs_to(part))


def _trials(
    study: Study, part: str, shown: Shown, of_segment: Mapping[str, int]
) -> tuple[Trials, int]:
    """Return the trials of one block of tests, and how many blocks there are of each question."""
    if isinstance(study, MismatchStudy) and part == FIT:
        # Every condition is tested by itself, and has as many trials as any other.
        first = next(iter(study.conditions))
        own = [one for one in shown if one[1].conditions[0] == first]
        owned = [
            tuple(int(stimulus.speech != stimulus.segment) for stimulus in trial.stimuli)
            for _, trial in own
        ]
        return _of(own, of_segment, 2, owned), len(study.conditions)
    if isinstance(study, RatingStudy | RankingStudy):
        parts = study.sets if isinstance(study, RatingStudy) else study.blocks
        (conditions,) = (one.conditions for one in parts if one.name == part)
        return _of(shown, of_segment, len(conditions)), 1
    compared = study.arms[0].conditions
    number = {name: place for place, name in enumerate(compared)}
    sides = [tuple(number[name] for name in trial.conditions) for _, trial in shown]
    return _of(shown, of_segment, len(compared), sides), len(study.arms)


def _of(
    shown: Shown,
    of_segment: Mapping[str, int],
    conditions: int,
    sides: Sequence[tuple[int, ...]] | None = None,
) -> Trials:
    left = right = None
    if sides is not None:
        left, right = np.array(sides, np.intp).reshape(-1, 2).T
    return Trials(
        participants=np.array([who for who, _ in shown], np.intp),
        items=np.array([of_segment[trial.segment.name] for _, trial in shown], np.intp),
        conditions=conditions,
        left=left,
        right=right,
    )
