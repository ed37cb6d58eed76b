"""What planned participants see is counted, and what is uneven is told."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from studyapp.preflight.design_checks import (
    Plans,
    balance_findings,
    counts_of_pairs,
    counts_of_segments,
    orders_of_pairs,
    places_of_conditions,
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


def shares(of: Iterable[object]) -> list[str]:
    return [f"{share.what}: {share.times} of {share.of}" for share in of]  # type: ignore[attr-defined]


def test_sides_and_orders_and_segments_are_counted() -> None:
    plans = [plan("ab", "ab", "ba", "ac"), plan("ac", "ab")]

    assert shares(places_of_conditions(plans)) == [
        "'a' stands left of b: 3 of 4",
        "'b' stands left of a: 1 of 4",
        "'a' stands left of c: 2 of 2",
        "'c' stands left of a: 0 of 2",
    ]
    assert shares(orders_of_pairs(plans)) == ["a and b come before a and c: 1 of 2"]
    assert counts_of_pairs(plans) == {"": {("a", "b"): 4, ("a", "c"): 2}}
    assert counts_of_segments(plans, [SEGMENT.name, OTHER.name]) == {SEGMENT.name: 6, OTHER.name: 0}


def test_only_analysed_trials_count() -> None:
    assert counts_of_pairs([plan("ab", kind="practice"), plan("ab", kind="catch")]) == {}


def test_the_projects_own_designs_are_balanced() -> None:
    assert found(make_study()) == ["balance"]
    assert found(make_study(comparisons="all_pairs", participants=60)) == ["balance"]


def test_what_follows_answers_is_not_counted_beforehand() -> None:
    assert found(make_study(comparisons="adaptive", participants=60)) == ["balance"]


def test_a_side_that_comes_too_often_is_told() -> None:
    assert "sides-uneven" in found(make_study(), [plan(*["ab"] * 6, *["ba"] * 4)] * 40)
    assert "sides-uneven" not in found(make_study(), [plan(*["ab"] * 5, *["ba"] * 5)] * 40)


def test_an_order_that_is_always_the_same_is_told() -> None:
    assert "orders-uneven" in found(make_study(), [plan("ab", "ba", "ac", "ca")] * 40)
    turned = [plan("ab", "ba", "ac", "ca"), plan("ac", "ca", "ab", "ba")] * 20
    assert "orders-uneven" not in found(make_study(), turned)


def test_conditions_that_come_too_rarely_and_segments_that_nobody_sees_are_told() -> None:
    names = found(make_study(), [plan("ab", "ba", "ab", "ba", "ac", "ca")] * 10)

    assert {"conditions-uneven", "segments-unused"} <= set(names)
