from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statsmodels.stats.multitest import multipletests

from analysis.preferences.win_share import compare, compare_by_emotion, holm
from analysis.responses import responses_frame

PAIR = ("ours_vs_other", "ours", "other")


def table(answer, values, **columns):
    """Return answers of participants (rows) about segments (columns), reference on the left."""
    return responses_frame(
        [
            answer(study_session=f"s{r}", segment=f"g{c}", position=c + 1, value=value, **columns)
            for r, row in enumerate(values)
            for c, value in enumerate(row)
        ]
    )


def test_wins_count_one_and_ties_one_half(answer):
    [found] = compare(table(answer, [[-2, -1, 0], [1, 0, -1]]), [PAIR], ["synchronisation"])
    assert found.counts.levels == (1, 2, 2, 1, 0)
    assert found.win_share.estimate == pytest.approx((3 + 0.5 * 2) / 6)
    assert (found.win_share.participants, found.win_share.segments) == (2, 3)


def test_how_strong_a_preference_is_does_not_move_the_win_share(answer):
    slight = compare(table(answer, [[-1, 1], [-1, 0]]), [PAIR], ["synchronisation"])
    clear = compare(table(answer, [[-2, 2], [-2, 0]]), [PAIR], ["synchronisation"])
    assert slight[0].win_share == clear[0].win_share


def test_a_comparison_without_answers_is_still_reported(answer):
    found = compare(
        table(answer, [[-1, 1], [-1, 0]]),
        [PAIR, ("ours_vs_third", "ours", "third")],
        ["synchronisation", "emotion"],
    )
    assert [(p.other, p.question, p.win_share.answers) for p in found] == [
        ("other", "synchronisation", 4),
        ("other", "emotion", 0),
        ("third", "synchronisation", 0),
        ("third", "emotion", 0),
    ]
    assert all(p.win_share.reason == "no answers" for p in found[1:])
    assert all(math.isnan(p.holm_p) for p in found[1:])


def test_holm_worked_by_hand():
    assert holm([0.01, 0.04, 0.03, 0.2]) == pytest.approx((0.04, 0.09, 0.09, 0.2))


def test_a_missing_test_stays_a_member_of_the_family():
    corrected = holm([0.01, math.nan, 0.02])
    assert corrected[0] == pytest.approx(0.03)
    assert math.isnan(corrected[1])
    assert corrected[2] == pytest.approx(0.04)
    assert holm([]) == ()


@settings(max_examples=15, deadline=None)  # statsmodels collects garbage at every call
@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_never_lowers_a_p_value_and_keeps_their_order(p_values):
    corrected = np.array(holm(p_values))
    assert np.all(corrected >= np.array(p_values) - 1e-12)
    assert np.all(np.diff(corrected[np.argsort(p_values, kind="stable")]) >= -1e-12)


def test_emotions_split_the_answers_and_belong_to_no_family(simulated_study):
    study = simulated_study(participants=8, segments=16)
    responses = study.responses()
    main = responses[responses["kind"] == "main"]
    pair = ("rule_based_vs_static", "rule_based", "static")
    found = compare_by_emotion(main, [pair], ["emotion"])
    [whole] = compare(main, [pair], ["emotion"])
    assert sum(p.counts.total for p in found) == whole.counts.total
    assert len({p.emotion for p in found}) == len(found) == 8
    assert all(math.isnan(p.holm_p) for p in found)


def test_one_segment_in_an_emotion_gives_no_interval(simulated_study):
    study = simulated_study(participants=8, segments=8)
    responses = study.responses()
    main = responses[responses["kind"].isin(["main", "repeat"])]
    pair = ("rule_based_vs_static", "rule_based", "static")
    reasons = {p.win_share.reason for p in compare_by_emotion(main, [pair], ["emotion"])}
    assert reasons == {"one segment"}


def test_the_correction_agrees_with_statsmodels() -> None:
    family = np.random.default_rng(1).beta(0.4, 2.0, 30).round(3)
    expected = multipletests(family, method="holm")[1]
    assert holm(family.tolist()) == pytest.approx(expected.tolist())
