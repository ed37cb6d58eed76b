from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.answers.columns import ANALYSED_KINDS
from analysis.answers.layouts import LAYOUTS
from analysis.answers.reading import read_answers
from analysis.results.against_people.people_side import tallies
from tests.analysis.results.made_tables import TABLES


def _answers(protocol: str, rows: pd.DataFrame, folder: Path) -> pd.DataFrame:
    rows.to_csv(folder / "answers.csv", index=False)
    table = read_answers(folder / "answers.csv", LAYOUTS[protocol])
    return table.shown[table.shown["kind"].isin(ANALYSED_KINDS)].reset_index(drop=True)


@pytest.mark.parametrize("protocol", TABLES)
def test_every_answer_is_counted_once(protocol, tmp_path):
    answers = _answers(protocol, TABLES[protocol](), tmp_path)
    found = tallies(protocol, answers)
    assert found.cells[1].sum() == len(answers)
    assert found.participants == answers["participant"].nunique()
    assert set(found.segments) == set(answers["segment"])


def test_a_win_counts_for_the_first_of_a_pair_wherever_it_stood(tmp_path):
    rows = pd.DataFrame(
        [
            ("p1", "s1", "q", "x", "y", 1),
            ("p1", "s2", "q", "y", "x", 5),
            ("p2", "s1", "q", "x", "y", 3),
            ("p2", "s2", "q", "y", "x", 2),
        ],
        columns=["participant", "segment", "question", "left", "right", "response"],
    )
    found = tallies("pairwise", _answers("pairwise", rows, tmp_path))
    sums, counts = found.cells
    first = found.conditions[found.groups[0, 0]]
    share = sums.sum() / counts.sum()
    assert share == pytest.approx(2.5 / 4 if first == "x" else 1.5 / 4)


def test_own_speech_wins_wherever_it_was_heard(tmp_path):
    rows = pd.DataFrame(
        [
            ("p1", "s1", "q", "x", "own", "other", 1),
            ("p1", "s2", "q", "x", "other", "own", 5),
            ("p2", "s1", "q", "x", "other", "own", 1),
        ],
        columns=[
            *("participant", "segment", "question", "condition"),
            *("left_speech", "right_speech", "response"),
        ],
    )
    found = tallies("mismatch", _answers("mismatch", rows, tmp_path))
    assert found.cells[0].sum() == 2


def test_tied_ranks_share_their_places_and_the_best_is_highest(tmp_path):
    rows = pd.DataFrame(
        [("p1", "s1", "q", "x", 1), ("p1", "s1", "q", "y", 2), ("p1", "s1", "q", "z", 2)],
        columns=["participant", "segment", "question", "condition", "rank"],
    )
    found = tallies("ranking", _answers("ranking", rows, tmp_path))
    by_condition = dict(zip(found.conditions, found.cells[0].ravel(), strict=True))
    assert by_condition == {"x": -1.0, "y": -2.5, "z": -2.5}


def test_many_participants_are_kept_as_a_sparse_table():
    answers = pd.DataFrame(
        {
            "participant": pd.Categorical([f"p{n}" for n in range(200)]),
            "segment": pd.Categorical([f"s{n % 50}" for n in range(200)]),
            "condition": pd.Categorical([f"c{n % 3}" for n in range(200)]),
            "value": np.ones(200),
        }
    )
    found = tallies("rating", answers)
    assert not isinstance(found.counts, np.ndarray)
    assert found.cells[1].sum() == 200
