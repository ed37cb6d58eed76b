"""The study file as a plan needs it: its own trials, for other numbers of people and segments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain, zip_longest
from typing import Any, Final

import numpy as np

from analysis.answers.columns import ANALYSED_KINDS
from analysis.planning.part import Size, Test, kept
from motion.errors import InputError
from motion.segment import EMOTIONS, Segment
from studyapp.planning.planned_parts import planned_parts
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.mismatch import MismatchStudy
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study

EXCLUDED: Final = 0.1
"""Share of participants who are taken to be left out where nobody has taken part."""

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
    test : {'report', 'crossed_lmm'}
        What decides.
    excluded : float
        Share of participants who will be left out.
    """

    study: Study
    segments: tuple[Segment, ...]
    test: Test
    excluded: float

    def size(self, participants: int, items: int) -> Size:
        """Return the study with so many places in each arm, and so many segments."""
        study = with_participants(self.study, participants)
        segments = with_items(self.segments, items)
        count = kept(participants, self.excluded)
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
        parts = tuple(planned_parts(study, shown, of_segment, self.test))
        return Size(
            participants=participants,
            items=items,
            recruited=participants * len(study.arms),
            analysed=count,
            trials=round(len(shown) / max(count, 1)),
            parts=parts if len(parts) > 1 else tuple(replace(part, name="") for part in parts),
        )


def own_participants(study: Study) -> int:
    """Return how many places each arm of the study has."""
    return study.arms[0].places


def excluded_by_default(study: Study) -> float:
    """Return the share of participants who are taken to be left out.

    Where somebody else takes the places of excluded participants, nobody is missing.
    """
    return 0.0 if study.replace_excluded else EXCLUDED


def has_segments(folder: StudyFolder, study: Study) -> bool:
    """Tell whether the study has segments already."""
    return (folder.speech / "segments.csv").exists() or study.only_finished


def planned_segments(
    folder: StudyFolder, study: Study, items: Sequence[int]
) -> tuple[Segment, ...]:
    """Return the study's segments, or made-up ones as many as are tried.

    Raises
    ------
    InputError
        If there are no segments yet, and none are tried either.
    """
    if has_segments(folder, study):
        return tuple(folder.segments_of(study))
    if not items:
        raise InputError(
            "the study has no speech yet, so that it is not known how many segments it will have",
            where=folder.root,
            remedy="Say it with --items, such as --items 24,48, or bring recordings in with "
            "'motionjury import'",
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
            end=lengths[number % len(lengths)],
            speaker="speaker",
            emotion=EMOTIONS[number // len(lengths) % len(EMOTIONS)],
            transcript="",
        )
        for number in range(max(items))
    )


def with_items(segments: Sequence[Segment], items: int) -> tuple[Segment, ...]:
    """Return so many segments like those of a study, as even over emotions as they are."""
    by_emotion: dict[str, list[Segment]] = {}
    for segment in segments:
        by_emotion.setdefault(segment.emotion, []).append(segment)
    ring = [one for one in chain(*zip_longest(*by_emotion.values())) if one is not None]
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


def with_trials(study: Study, trials: int) -> Study:
    """Return the study with so many trials of each part for every participant, at most 500."""
    count = min(trials, 500)
    update: dict[str, Any]
    match study:
        case PairwiseStudy():
            update = {"trials": count, "practice": min(study.practice, count)}
        case RatingStudy():
            update = {"sets": tuple(s.model_copy(update={"groups": count}) for s in study.sets)}
        case RankingStudy():
            blocks = tuple(b.model_copy(update={"trials": count}) for b in study.blocks)
            update = {"blocks": blocks}
        case MismatchStudy():
            update = dict.fromkeys(study.parts, count)
        case _:
            raise TypeError(f"a plan knows no {type(study).__name__}")
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
