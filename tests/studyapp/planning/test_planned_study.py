from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.planning.part import Part
from motion.errors import InputError
from studyapp.planning.planned_study import (
    PlannedStudy,
    excluded_by_default,
    notes_of,
    planned_segments,
    with_items,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from studyapp.study.study_file import new_study
from studyapp.study.study_options import read_conditions
from tests.support.studies.made_study import make_segments, make_study

SEGMENTS = make_segments(["anger", "sadness", "fear"] * 4)


def template(name: str, folder: Path) -> Study:
    return new_study(folder / "study.toml", template=name, name="planned")


def planned(study: Study, *, excluded: float = 0.0) -> PlannedStudy:
    return PlannedStudy(study=study, segments=SEGMENTS, excluded=excluded)


def only(study: Study, participants: int = 6, items: int = 12, *, excluded: float = 0.0) -> Part:
    (part,) = planned(study, excluded=excluded).size(participants, items).parts
    return part


def test_simulated_trials_are_those_of_the_study() -> None:
    study = make_study(trials=5, practice=2)
    size = planned(study).size(6, 12)
    (part,) = size.parts
    arm = study.arms[0]
    main = [t for t in study.plan(arm, 3, with_items(SEGMENTS, 12)) if t.kind in ("main", "repeat")]
    names = [segment.name for segment in with_items(SEGMENTS, 12)]

    assert size.recruited == 12
    assert size.trials == 5
    own = part.trials.participants == 3
    assert part.trials.left is not None
    assert [names[item] for item in part.trials.items[own]] == [t.segment.name for t in main]
    assert part.trials.left[own].tolist() == [arm.conditions.index(t.conditions[0]) for t in main]


@pytest.mark.parametrize(
    ("keys", "blocks", "conditions", "pairs"),
    [
        ({"trials": 5}, 4, 2, [30]),
        ({"comparisons": "all_pairs", "participants": 6, "trials": 9}, 2, 3, [18, 18, 18]),
        ({"comparisons": "adaptive", "participants": 6, "trials": 9}, 2, 3, [18, 18, 18]),
    ],
)
def test_every_comparison_and_question_is_a_test(
    keys: dict[str, Any], blocks: int, conditions: int, pairs: list[int]
) -> None:
    study = make_study(**keys)
    part = only(study)

    assert (part.blocks, part.tests, part.levels) == (blocks, blocks * len(pairs), 5)
    assert part.trials.conditions == conditions
    assert [len(part.trials.of_pair(a, b)) for a, b in part.trials.pairs] == pairs
    assert any("Adaptive pairs" in note for note in notes_of(study)) == study.follows_votes


def test_excluded_participants_are_missing_unless_they_are_replaced() -> None:
    assert excluded_by_default(make_study(replace_excluded=True)) == 0
    share = excluded_by_default(make_study())
    size = planned(make_study(trials=5), excluded=share).size(25, 12)

    assert size.analysed == 22
    assert size.parts[0].trials.analysed == 22


def test_added_segments_resemble_existing_ones() -> None:
    more = with_items(SEGMENTS, 30)
    few = with_items(SEGMENTS, 6)

    assert len({segment.name for segment in more}) == 30
    assert Counter(segment.emotion for segment in more) == {"anger": 10, "sadness": 10, "fear": 10}
    assert Counter(segment.emotion for segment in few) == {"anger": 2, "sadness": 2, "fear": 2}
    assert {segment.name for segment in few} < {segment.name for segment in SEGMENTS}


@pytest.mark.parametrize(
    ("name", "kind"), [("rating", "ratings"), ("ranking", "rankings"), ("mismatch", "pairs")]
)
def test_every_protocol_has_parts(name: str, kind: str, tmp_path: Path) -> None:
    study = template(name, tmp_path)
    segments = planned_segments(StudyFolder(tmp_path), study, (24,))
    any_size = PlannedStudy(study=study, segments=segments, excluded=0.0)
    size = any_size.size(6, 24)

    for each in (size, any_size.size(6, 8)):
        assert tuple(part.name for part in each.parts) == study.parts
    assert {part.kind for part in size.parts} == {kind}
    for part in size.parts:
        asked = sum(question.belongs_to(part.name) for question in study.questions)
        assert part.blocks % asked == 0
        assert part.trials.analysed == 6
        shown = np.stack([part.trials.participants, part.trials.items])
        assert len(np.unique(shown, axis=1).T) == shown.shape[1]


def test_a_block_for_which_every_segment_is_too_short_leaves_the_others_to_be_planned(
    tmp_path: Path,
) -> None:
    study = template("ranking", tmp_path)
    assert study.parts == ("long", "short")

    part = only(study)

    assert (part.trials.conditions, part.trials.analysed) == (3, 6)


@pytest.mark.parametrize("source", ["files", "videos"])
def test_a_plan_without_material_needs_the_number_of_segments(tmp_path: Path, source: str) -> None:
    texts = (f"ours={source}", f"theirs={source}")
    conditions = read_conditions(texts, tmp_path)
    study = new_study(tmp_path / "study.toml", name="planned", conditions=conditions)
    folder = StudyFolder(tmp_path)

    assert not folder.has_segments(study)
    with pytest.raises(InputError, match="--items"):
        planned_segments(folder, study, ())
    assert len(planned_segments(folder, study, (8, 16))) == 16
