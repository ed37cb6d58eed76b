from __future__ import annotations

from itertools import product
from typing import Any

import pytest

from studyapp.study.design.trial import AnswerKey, PlannedTrial
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.study_file import new_study
from tests.studyapp.study.protocols.made_protocols import lasting, make
from tests.support.studies.made_study import make_segments

BLOCKS = [
    {"name": "long", "conditions": ["ours", "theirs", "static"], "trials": 8, "shortest": 30},
    {"name": "short", "conditions": ["ours", "theirs"], "trials": 12, "longest": 30},
]


def first_trial(**changes: Any) -> tuple[RankingStudy, PlannedTrial]:
    study = make("ranking", **changes)
    assert isinstance(study, RankingStudy)
    return study, study.plan(study.arms[0], 0, make_segments(["anger"] * 8))[0]


def ranks(*values: int) -> dict[AnswerKey, int]:
    """Return the same ranks for both questions."""
    return {
        (question, number): value
        for question, (number, value) in product(("realism", "diversity"), enumerate(values, 1))
    }


def test_the_template_asks_the_four_questions(tmp_path: Any) -> None:
    study = new_study(tmp_path / "study.toml", template="ranking", name="s")

    assert isinstance(study, RankingStudy)
    assert [block.trials for block in study.blocks] == [8, 12]
    assert [len(block.conditions) for block in study.blocks] == [5, 3]
    assert (study.participants, len(study.questions), study.ties) == (22, 4, False)


def test_a_block_has_the_segments_of_its_length() -> None:
    study = make("ranking", blocks=BLOCKS)
    segments = lasting(*[60.0] * 9, *[10.0] * 13)

    plan = study.plan(study.arms[0], 0, segments)

    assert [trial.part for trial in plan] == ["long"] * 8 + ["short"] * 12
    assert {(trial.part, trial.segment.duration) for trial in plan} == {
        ("long", 60.0),
        ("short", 10.0),
    }
    assert len({trial.segment for trial in plan}) == 20


@pytest.mark.parametrize(
    ("given_ranks", "strict", "with_ties"),
    [
        ((1, 1, 2), "question 1, two videos have the same rank", ""),
        ((1, 1, 1), "two videos have the same rank", ""),
        ((1, 1, 3), "two videos have the same rank", "a rank is left out"),
        ((2, 2, 3), "two videos have the same rank", "a rank is left out"),
    ],
)
def test_ties_are_accepted_only_where_the_study_says_so(
    given_ranks: tuple[int, ...], strict: str, with_ties: str
) -> None:
    study, trial = first_trial()
    tolerant, _ = first_trial(ties=True)

    assert strict in str(study.problem(trial, ranks(*given_ranks)))
    said = tolerant.problem(trial, ranks(*given_ranks))
    assert with_ties in str(said)
    assert (said is not None) == bool(with_ties)
