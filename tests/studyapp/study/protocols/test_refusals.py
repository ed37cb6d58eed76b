"""Mismatches with a protocol and too little speech are reported."""

import re
from typing import Any

import pytest

from motion.errors import InputError
from tests.studyapp.study.protocols.made_protocols import KEYS, LABELS, make, question
from tests.support.studies.made_study import make_segments

FIT = question("q")
LONG = {"name": "long", "conditions": ["ours", "theirs"], "trials": 8, "shortest": 30}
LASTING = {**LONG, "name": "short", "shortest": 0, "longest": 30, "trials": 12}


def labelled(**more: Any) -> dict[str, Any]:
    return {"questions": [question("q", **{"labels": LABELS, **more})]}


def a_set(*conditions: str) -> dict[str, Any]:
    return {"sets": [{"name": "a", "conditions": conditions}]}


@pytest.mark.parametrize(
    ("protocol", "changes", "said"),
    [
        ("pairwise", {"participants": 5}, "participants has no effect"),
        ("pairwise", {"conditions": {"ours": {"videos": True}, "b": {}}}, "cannot be composed"),
        ("rating", {"questions": [FIT]}, "give five labels"),
        ("rating", labelled(scale="mean_opinion"), "its own labels"),
        ("rating", labelled(parts=["two"]), "unknown part 'two'"),
        ("rating", labelled(parts=["four"]), "part 'three' has no questions"),
        ("rating", a_set("ours", "nobody"), "'nobody' is not a condition"),
        ("rating", {"sets": KEYS["rating"]["sets"][:1] * 2}, "the same name"),
        ("ranking", {"reference": "ours"}, "the reference cannot be ranked"),
        ("ranking", {"catch": {"trials": 1, "against": "real"}}, "the reference is not ranked"),
        ("mismatch", {"fit": 0, "realism": 0, "questions": [FIT]}, "there is no task"),
        ("mismatch", {"conditions": {"ours": {}}}, "there is only one"),
        ("mismatch", {"realism": 0, "questions": [FIT], "catch": {"trials": 1}}, "realism"),
    ],
)
def test_inconsistent_studies_are_refused(
    protocol: str, changes: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        make(protocol, **changes)


@pytest.mark.parametrize(
    ("protocol", "changes", "emotions", "said"),
    [
        ("rating", {}, ["anger"] * 7, []),
        ("rating", {}, ["anger"] * 6, ["7 groups, but the study has only 6 segments"]),
        ("ranking", {"blocks": [LASTING]}, ["anger"] * 12, []),
        (
            "ranking",
            {"blocks": [LASTING]},
            ["anger"] * 11,
            ["block short has 11 segments for its 12 trials"],
        ),
        ("ranking", {"reference": None}, ["anger"] * 12, ["no reference is shown"]),
        (
            "pairwise",
            {"trials": 24, "practice": 3},
            ["anger"] * 2,
            [
                "with 2 segments of anger, a participant can judge 2 pairs",
                "2 pairs instead of 24, because the study has 2 segments",
            ],
        ),
        (
            "pairwise",
            {},
            ["anger"] * 5 + ["fear"],
            [
                "can judge 6 pairs",
                "an even share is 3 segments each, but there are fewer of fear (1)",
            ],
        ),
        ("all_pairs", {}, ["anger"] * 3, ["can judge 9 pairs", "shows each 3 times"]),
    ],
)
def test_too_little_speech_and_missing_references_are_reported(
    protocol: str, changes: dict[str, Any], emotions: list[str], said: list[str]
) -> None:
    notes = make(protocol, **changes).notes(make_segments(emotions))

    assert [words in note for words, note in zip(said, notes, strict=True)] == [True] * len(said)
