"""The trials and tests of a study file, for other numbers of participants and segments."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, zip_longest
from typing import Any, Final

import numpy as np

from analysis.answers.table import ANALYSED_KINDS
from analysis.planning.part import Kind, Part, Size, Trials
from motion.errors import InputError
from motion.segment import EMOTIONS, Segment
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.mismatch import FIT, MismatchStudy
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study

Shown = Sequence[tuple[int, PlannedTrial]]
"""Who is shown which trials."""

_KINDS: Final[Mapping[str, Kind]] = {"rating": "ratings", "ranking": "rankings"}


def planned_parts(study: Study, shown: Shown, of_segment: Mapping[str, int]) -> Iterator[Part]:
    """Yield the parts of a study, and those questions of a part apart that have other scales.

    A part without a single trial, such as a block for long segments where all are short, is left
    out unless there are no trials at all.

    Parameters
    ----------
    study : Study
        Whose trials they are.
    shown : sequence of (int, PlannedTrial)
        The analysed trials of one arm, with the number of the participant.
    of_segment : mapping of str to int
        Numbers of the segments.
    """
    used = {trial.part for _, trial in shown}
    for name in [part for part in study.parts if part in used] or study.parts or ("",):
        part_trials = [(participant, trial) for participant, trial in shown if trial.part == name]
        trials, alike = _trials(study, name, part_trials, of_segment)
        scales = _scales(study, name)
        for levels, questions in scales.items():
            yield Part(
                name=name if len(scales) == 1 else f"{name} ({levels} levels)".strip(),
                kind=_KINDS.get(study.protocol, "pairs"),
                trials=trials,
                levels=levels,
                blocks=questions * alike,
                family=name if isinstance(study, MismatchStudy) else "",
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
        fit_trials = [each for each in shown if each[1].conditions[0] == first]
        owned = [
            tuple(int(stimulus.speech != stimulus.segment) for stimulus in trial.stimuli)
            for _, trial in fit_trials
        ]
        return _of(fit_trials, of_segment, 2, owned), len(study.conditions)
    if isinstance(study, RatingStudy | RankingStudy):
        parts = study.sets if isinstance(study, RatingStudy) else study.blocks
        (conditions,) = (each.conditions for each in parts if each.name == part)
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
        participants=np.array([participant for participant, _ in shown], np.intp),
        items=np.array([of_segment[trial.segment.name] for _, trial in shown], np.intp),
        conditions=conditions,
        left=left,
        right=right,
    )


EXCLUDED: Final = 0.1
"""Share of participants who are assumed to be excluded where nobody has taken part."""

_LONG: Final = 60.0
"""Seconds of a made-up segment where a block takes longer ones too."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlannedStudy:
    """A study of any size, made from its file.

    Attributes
    ----------
    study : Study
        The study file.
    segments : tuple of Segment
        Its segments, or made-up ones where there are none yet.
    excluded : float
        Share of participants who will be left out.
    """

    study: Study
    segments: tuple[Segment, ...]
    excluded: float

    def size(self, participants: int, items: int) -> Size:
        """Return the study with so many places in each arm, and so many segments."""
        study = with_participants(self.study, participants)
        segments = with_items(self.segments, items)
        count = participants - int(participants * self.excluded + 0.5)
        chance = np.random.default_rng([study.seed, participants])
        places = np.sort(chance.choice(participants, count, replace=False)).tolist()
        arm = study.arms[0]
        shown = [
            (number, trial)
            for number, place in enumerate(places)
            for trial in study.plan(arm, place, segments)
            if trial.kind in ANALYSED_KINDS
        ]
        of_segment = {segment.name: number for number, segment in enumerate(segments)}
        parts = tuple(planned_parts(study, shown, of_segment))
        return Size(
            participants=participants,
            items=items,
            recruited=participants * len(study.arms),
            analysed=count,
            trials=round(len(shown) / max(count, 1)),
            parts=parts if len(parts) > 1 else tuple(replace(part, name="") for part in parts),
        )


def excluded_by_default(study: Study) -> float:
    """Return the share of participants who are assumed to be excluded.

    None are missing where others take the places of excluded participants.
    """
    return 0.0 if study.replace_excluded else EXCLUDED


def planned_segments(
    folder: StudyFolder, study: Study, items: Sequence[int]
) -> tuple[Segment, ...]:
    """Return the study's segments, or made-up ones as many as are tried.

    Raises
    ------
    InputError
        If there are no segments yet, and none are tried either.
    """
    if folder.has_segments(study):
        return folder.segments_of(study)
    if not items:
        raise InputError(
            "the study has no segments yet, so it is not known how many it will have",
            where=folder.root,
            remedy="Import speech or videos first (--items 24,48 tries numbers of your own)",
        )
    lengths = [30.0]
    if isinstance(study, RankingStudy):
        lengths = [
            (block.shortest + min(block.longest, block.shortest + _LONG)) / 2
            for block in study.blocks
        ]
    return tuple(
        Segment(
            name=f"segment-{number}",
            wav=f"segment-{number}.wav",
            start=0.0,
            # Any few of them have all lengths.
            end=lengths[(number + number // len(EMOTIONS)) % len(lengths)],
            speaker="speaker",
            emotion=EMOTIONS[number % len(EMOTIONS)],
            transcript="",
        )
        for number in range(max(items))
    )


def with_items(segments: Sequence[Segment], items: int) -> tuple[Segment, ...]:
    """Return so many segments like those of a study, as even over emotions as they are."""
    by_emotion: dict[str, list[Segment]] = {}
    for segment in segments:
        by_emotion.setdefault(segment.emotion, []).append(segment)
    ring = [segment for segment in chain(*zip_longest(*by_emotion.values())) if segment is not None]
    return tuple(
        ring[number]
        if number < len(ring)
        else replace(
            ring[number % len(ring)],
            name=f"{ring[number % len(ring)].name}-{number // len(ring) + 1}",
        )
        for number in range(items)
    )


def with_participants(study: Study, participants: int) -> Study:
    """Return the study with so many places in each arm; adaptive pairs are shown evenly."""
    update: dict[str, Any] = {"participants": participants}
    if isinstance(study, PairwiseStudy):
        if study.has_reference_arms:
            update = {"participants_per_comparison": participants}
        elif study.follows_votes:
            update["comparisons"] = "all_pairs"
    return study.model_copy(update=update)


def notes_of(study: Study) -> tuple[str, ...]:
    """Return what a plan of this study leaves out, as sentences."""
    notes = []
    if study.follows_votes:
        notes.append(
            "Adaptive pairs are simulated as evenly shown ones: what they gain is not in it."
        )
    if isinstance(study, RankingStudy) and study.ties:
        notes.append("Rankings are simulated without ties.")
    if study.margin is not None:
        notes.append(
            "Whether conditions are found equivalent within the study's margin is not simulated."
        )
    return tuple(notes)
