from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.answers.participants import leave_out
from analysis.planning.part import THRESHOLDS, Opinions
from analysis.planning.pilot_spreads import pilot_opinions
from benchmarks.validity.studies import Design, judgements, preferences, ranks, ratings
from motion.errors import InputError
from tests.analysis.results.made_tables import read_table

DESIGN = Design(participants=40, items=25, effect=0.4, participant_sd=0.8, item_sd=0.6)
NAMES = np.array(["a", "b", "c"])


def estimated(
    rows: Mapping[str, object], protocol: str, folder: Path
) -> tuple[float, float, Opinions]:
    table = read_table(pd.DataFrame({"question": "realism", **rows}), protocol, folder)
    opinions, answers = pilot_opinions(table, leave_out(table, ()).analysed)
    assert answers > 0
    return opinions.participant_sd, opinions.item_sd, opinions


def numbered(kind: str, codes: np.ndarray) -> list[str]:
    return [f"{kind}{code:03}" for code in codes.tolist()]


def test_spreads_and_thresholds_of_preferences_are_recovered(tmp_path: Path) -> None:
    study = preferences(DESIGN, np.random.default_rng(4))
    right = study.side > 0
    rows = {
        "participant": numbered("p", study.participants),
        "segment": numbered("s", study.items),
        "left": np.where(right, "b", "a"),
        "right": np.where(right, "a", "b"),
        "response": study.responses,
    }

    people, items, opinions = estimated(rows, "pairwise", tmp_path)

    assert people == pytest.approx(0.8, abs=0.25)
    assert items == pytest.approx(0.6, abs=0.25)
    assert (opinions.slight, opinions.clear) == pytest.approx(THRESHOLDS, abs=0.2)


@pytest.mark.parametrize(
    ("protocol", "seed", "column"), [("rating", 7, "response"), ("ranking", 5, "rank")]
)
def test_spreads_of_taste_are_recovered_from_ratings_and_rankings(
    protocol: str, seed: int, column: str, tmp_path: Path
) -> None:
    chance = np.random.default_rng(seed)
    judged = judgements(DESIGN, 3, chance)
    given = ratings(judged, DESIGN, chance) if protocol == "rating" else ranks(judged, chance)
    rows = {
        "participant": np.repeat(numbered("p", judged.participants), 3),
        "segment": np.repeat(numbered("s", judged.items), 3),
        "condition": np.tile(NAMES, len(given)),
        column: given.ravel(),
    }

    people, items, _ = estimated(rows, protocol, tmp_path)

    assert people == pytest.approx(0.8, abs=0.25)
    assert items == pytest.approx(0.6, abs=0.25)


def test_a_pilot_with_one_participant_has_no_spread(tmp_path: Path) -> None:
    rows = {
        "participant": ["p"] * 4,
        "segment": ["s", "t", "u", "v"],
        "left": "a",
        "right": "b",
        "response": [1, 2, 4, 5],
    }

    with pytest.raises(InputError, match="do not show how much opinions differ"):
        estimated(rows, "pairwise", tmp_path)
