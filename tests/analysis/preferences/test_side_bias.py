from __future__ import annotations

import pytest

from analysis.preferences.side_bias import side_bias
from analysis.responses import responses_frame


def test_left_choices_count_whatever_they_show(answer):
    rows = []
    for person in range(2):
        for k, (value, left) in enumerate([(-2, "ours"), (-1, "other"), (0, "ours"), (1, "other")]):
            rows.append(
                answer(
                    study_session=f"s{person}",
                    segment=f"g{k}",
                    position=k + 1,
                    value=value,
                    left_condition=left,
                    right_condition="other" if left == "ours" else "ours",
                )
            )
    [found] = side_bias(responses_frame(rows), ["synchronisation"])
    assert found.left_share.estimate == pytest.approx((1 + 1 + 0.5 + 0) / 4)
    assert found.reference_on_left == 0.5
    [uneven] = side_bias(responses_frame(rows[:3]), ["synchronisation"])
    assert uneven.reference_on_left == pytest.approx(2 / 3)


def test_raters_who_always_choose_left_are_found(simulated_study):
    responses = simulated_study(participants=10, segments=12, effects={"static": 0.0}).responses()
    main = responses[responses["kind"] == "main"]
    honest = side_bias(main, ["emotion"])[0]
    assert honest.left_share.low < 0.5 < honest.left_share.high
    biased = main.assign(value=main["value"].where(main["position"] % 2 > 0, -2))
    assert side_bias(biased, ["emotion"])[0].left_share.p_value < 0.01


def test_no_answers_give_a_reason():
    [found] = side_bias(responses_frame([]), ["emotion"])
    assert found.left_share.reason == "no answers"
