"""What planned participants see is counted, and what is uneven is told."""

from __future__ import annotations

from pathlib import Path

from studyapp.preflight.design_checks import (
    Plans,
    balance_findings,
    counts_of_pairs,
    counts_of_segments,
)
from studyapp.preflight.material import Material
from studyapp.study.design.trial import PlannedTrial, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.studyapp.made_study import make_segments, make_study

(SEGMENT, OTHER) = make_segments(["neutral", "anger"])


def plan(*shown: str, kind: str = "main") -> tuple[PlannedTrial, ...]:
    """Return a trial for each text of conditions, such as ``ab``."""
    return tuple(
        PlannedTrial(
            position=position,
            kind=kind,  # type: ignore[arg-type]
            segment=SEGMENT,
            videos=tuple((Stimulus.own(condition, SEGMENT.name),) for condition in conditions),
        )
        for position, conditions in enumerate(shown, start=1)
    )


def found(study: PairwiseStudy, plans: Plans | None = None) -> list[str]:
    material = Material(
        folder=StudyFolder(Path()),
        study=study,
        segments=make_segments(["neutral", "anger", "fear", "disgust"] * 3),
        media=None,
    )
    if plans is not None:
        # A cached property is kept here once it was reckoned.
        vars(material)["planned"] = ((study.arms[0], plans),)
    return [finding.name for finding in balance_findings(material)]


def test_pairs_and_segments_are_counted() -> None:
    plans = [plan("ab", "ab", "ba", "ac"), plan("ac", "ab")]
    assert counts_of_pairs(plans) == {"": {("a", "b"): 4, ("a", "c"): 2}}
    assert counts_of_segments(plans, [SEGMENT.name, OTHER.name]) == {SEGMENT.name: 6, OTHER.name: 0}


def test_the_projects_own_designs_are_balanced() -> None:
    assert found(make_study()) == ["balance"]
    assert found(make_study(comparisons="all_pairs", participants=60)) == ["balance"]


def test_what_follows_answers_is_not_counted_beforehand() -> None:
    assert found(make_study(comparisons="adaptive", participants=60)) == ["balance"]


def test_conditions_that_come_too_rarely_and_segments_that_nobody_sees_are_told() -> None:
    names = found(make_study(), [plan("ab", "ba", "ab", "ba", "ac", "ca")] * 10)

    assert {"conditions-uneven", "segments-unused"} <= set(names)
