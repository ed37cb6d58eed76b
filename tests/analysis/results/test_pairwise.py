import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.results.headline import retest_of
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm
from analysis.stats.ordinal.mixed_model import RandomEffect, fit, likelihood_ratio
from tests.analysis.results.made_tables import catch_rows, mismatch_table, pairwise_table, report_of


def results(folder: Path, table: pd.DataFrame, **options: Any) -> PairwiseResults:
    found = report_of(table, "pairwise", folder, **options).results
    assert isinstance(found, PairwiseResults)
    return found


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return pairwise_table(questions=("emotion", "rhythm"), participants=8, segments=5)


@pytest.fixture(scope="module")
def found(table: pd.DataFrame, tmp_path_factory: pytest.TempPathFactory) -> PairwiseResults:
    return results(tmp_path_factory.mktemp("pairwise"), table, margin=0.45)


def test_a_comparison_agrees_with_its_parts(table: pd.DataFrame, found: PairwiseResults) -> None:
    assert [c.question for c in found.comparisons] == ["emotion", "rhythm"] * 3

    one = next(c for c in found.comparisons if {c.a, c.b} == {"ours", "static"})
    own = table[
        (table["kind"] != "practice")
        & (table["question"] == one.question)
        & table["left"].isin([one.a, one.b])
        & table["right"].isin([one.a, one.b])
    ]
    side = np.where(own["right"] == one.a, 1.0, -1.0)
    towards = side * (own["response"] - 3)
    random = [
        RandomEffect(name=name, groups=own[name].to_numpy(str), multiplier=side)
        for name in ("participant", "segment")
    ]
    wins = ((np.sign(towards) + 1) / 2).to_numpy()
    share = clustered_mean(wins, *(effect.groups for effect in random))
    full = fit(own["response"].to_numpy(int), {"s": side}, random)
    reduced = fit(own["response"].to_numpy(int), {}, random)

    assert one.n == len(own) == sum(one.counts.values())
    assert one.counts["a_strong"] == (towards == 2).sum()
    assert one.counts["b_weak"] == (towards == -1).sum()
    assert sum(one.share.values()) == pytest.approx(100)
    assert (one.win_share.estimate, one.win_share.low, one.win_share.high) == pytest.approx(
        (share.estimate, share.low, share.high)
    )
    assert one.clmm.estimate == pytest.approx(full.estimates["s"], abs=1e-4)
    assert one.clmm.standard_error == pytest.approx(full.standard_errors["s"], rel=1e-3)
    assert one.clmm.log_likelihood == pytest.approx(full.log_likelihood, abs=1e-4)
    assert one.clmm.p_value == pytest.approx(likelihood_ratio(full, reduced)[2], rel=1e-3)
    assert one.as_published.binomial_p < one.clmm.p_value
    assert [c.decision.p_holm for c in found.comparisons] == pytest.approx(
        holm([c.decision.p_value for c in found.comparisons])
    )


def test_the_first_condition_is_a_and_results_flip_with_the_order(tmp_path: Path) -> None:
    table = pairwise_table(("x", "y"), effects=(0.8, 0.0), participants=8, segments=6)
    mirrored = table.assign(
        left=table["right"], right=table["left"], response=6 - table["response"]
    )
    [one], [other] = (results(tmp_path, of).comparisons for of in (table, mirrored))
    assert (one.a, one.b) == (other.b, other.a)
    assert one.a == table["left"].iloc[0]
    turned = one.mirrored()
    assert (turned.a, turned.counts, turned.share) == (other.a, other.counts, other.share)
    assert turned.clmm.estimate == pytest.approx(other.clmm.estimate, abs=1e-4)
    for name in ("estimate", "low", "high"):
        for number in ("win_share", "decision"):
            expected = getattr(getattr(other, number), name)
            assert getattr(getattr(turned, number), name) == pytest.approx(expected)


def test_sides_swapped_with_their_answers_change_no_count_and_no_agreement(
    table: pd.DataFrame, found: PairwiseResults, tmp_path: Path
) -> None:
    others = table.assign(left=table["right"], right=table["left"], response=6 - table["response"])
    some = table.index % 3 == 1
    swapped = results(tmp_path, pd.concat([table[~some], others[some]]).sort_index())

    for one, other in zip(found.comparisons, swapped.comparisons, strict=True):
        assert (one.counts, one.win_share) == (other.counts, other.win_share)
        assert one.as_published == other.as_published
    assert repr(swapped.agreement) == repr(found.agreement)
    assert repr(swapped.test_retest) == repr(found.test_retest)


def test_agreement_uses_the_first_answer_about_an_item(
    table: pd.DataFrame, found: PairwiseResults, tmp_path: Path
) -> None:
    contrary = table.assign(response=6 - table["response"])
    twice = pd.concat([table, contrary]).drop(columns="trial", errors="ignore")
    assert repr(results(tmp_path, twice).agreement) == repr(found.agreement)


def test_practice_trials_and_excluded_participants_are_not_analysed_but_repeats_are(
    tmp_path: Path,
) -> None:
    table = pairwise_table(("x", "y"), effects=(0.5, 0.0), participants=4, segments=5)
    found = results(tmp_path, table)
    [one] = found.comparisons
    assert one.n == 4 * 5
    contrary = table["response"].where(table["kind"] != "practice", 6 - table["response"])
    assert results(tmp_path, table.assign(response=contrary)).comparisons == (one,)
    assert found.test_retest.of_set(None)["emotion"].n == 4 * 2
    # Of an excluded participant.
    failed = pd.concat([table, catch_rows("p01", "lr", (3, 3))])
    [other] = results(tmp_path, failed).comparisons
    assert (other.recruited, other.attentive, other.n) == (4, 3, 3 * 5)
    assert other.without_exclusions.n == one.n


def test_sets_are_kept_apart_and_corrected_together(tmp_path: Path) -> None:
    table = pairwise_table(("x", "y"), effects=(0.8, 0.0), participants=6, segments=6)
    apart = table.assign(set=np.where(table["segment"] < "s3", "one", "two"))
    first, second = results(tmp_path, apart).comparisons
    [alone] = results(tmp_path, table[table["segment"] < "s3"]).comparisons
    assert (first.set, second.set) == ("one", "two")
    assert first.clmm == alone.clmm
    assert (first.decision.p_holm, second.decision.p_holm) == pytest.approx(
        holm([first.decision.p_value, second.decision.p_value])
    )


def test_equivalence_is_reported_if_a_margin_was_stated(found: PairwiseResults) -> None:
    assert len(found.equivalence) == len(found.comparisons)
    for equivalence, comparison in zip(found.equivalence, found.comparisons, strict=True):
        assert equivalence.estimate == pytest.approx(comparison.win_share.estimate - 0.5)
        inside = equivalence.low > -0.45 and equivalence.high < 0.45
        assert equivalence.verdict.startswith("equivalent") == inside


def test_the_win_share_decides_with_few_segments_and_the_model_with_many(tmp_path: Path) -> None:
    many = pairwise_table(("x", "y"), effects=(0.3, 0.0), participants=20, segments=20)
    few = many[many["segment"].isin(["s1", "s2", "s3", "s4", "s5"])].assign(question="rhythm")
    first, second = results(tmp_path, pd.concat([many, few])).comparisons

    assert (first.decision.by, first.decision.why) == ("clmm", "")
    assert first.decision.estimate == first.clmm.estimate
    assert second.decision.by == "win_share"
    assert second.decision.estimate == second.win_share.estimate
    assert second.decision.low == second.win_share.low
    assert "fewer than 20 participants or segments" in second.decision.why
    # One correction, whichever test decides.
    assert (first.decision.p_holm, second.decision.p_holm) == pytest.approx(
        holm([first.clmm.p_value, second.win_share.p_value])
    )


@pytest.mark.parametrize(
    ("size", "with_ties", "by"), [((12, 4), False, "sign"), ((20, 20), True, "win_share")]
)
def test_without_a_model_the_win_share_or_the_sign_test_decides(
    size: tuple[int, int], with_ties: bool, by: str, tmp_path: Path
) -> None:
    people, segments = size
    table = pairwise_table(("x", "y"), effects=(0.0, 0.0), participants=people, segments=segments)
    table["response"] = (table["left"] == "x").map({True: 1, False: 5})
    if with_ties:
        table.loc[table.index % 80 == 3, "response"] = 3
    [one] = results(tmp_path, table).comparisons

    assert math.isnan(one.clmm.p_value)
    assert one.decision.by == by
    assert one.decision.why.startswith(one.clmm.reason)
    assert one.decision.p_value == pytest.approx(2 * 0.5**12) or one.decision.p_value < 1e-6
    assert one.decision.estimate == (one.win_share.estimate if with_ties else 1)


@pytest.fixture(scope="module")
def five() -> pd.DataFrame:
    return pairwise_table(
        ("a", "b", "c", "d", "e"), participants=10, segments=6, effects=(1.5, 1.0, 0.5, 0.2, 0.0)
    )


def test_with_more_than_three_conditions_strengths_decide_unless_all_share_a_reference(
    five: pd.DataFrame, tmp_path: Path
) -> None:
    found = results(tmp_path, five)
    star = results(tmp_path, five[(five["left"] == "a") | (five["right"] == "a")])

    assert (found.decided_by, star.decided_by) == ("strengths", "comparisons")
    assert len(found.contrasts) == 10
    assert [contrast.p_holm for contrast in found.contrasts] == pytest.approx(
        holm([contrast.p_value for contrast in found.contrasts])
    )
    fitted = found.bradley_terry.of_set(None)["emotion"]
    assert fitted.omnibus.p_value < 0.1
    contrast = found.contrasts[0]
    strengths = {each.condition: each.estimate for each in fitted.conditions}
    assert contrast.estimate == pytest.approx(strengths[contrast.a] - strengths[contrast.b])


@pytest.mark.parametrize(
    ("family", "inside"),
    [
        ("against=e", {("a", "e"), ("b", "e"), ("c", "e"), ("d", "e")}),
        ("primary=a,e,emotion", {("a", "e")}),
    ],
)
def test_only_the_declared_family_decides(
    family: str, inside: set[tuple[str, str]], five: pd.DataFrame, tmp_path: Path
) -> None:
    found = results(tmp_path, five, family=family)

    members = [contrast for contrast in found.contrasts if not math.isnan(contrast.p_holm)]
    assert {tuple(sorted((contrast.a, contrast.b))) for contrast in members} == inside
    assert [contrast.p_holm for contrast in members] == pytest.approx(
        holm([contrast.p_value for contrast in members])
    )


def test_an_unbeaten_condition_has_a_strength_and_is_decided_by_the_sign_test(
    five: pd.DataFrame, tmp_path: Path
) -> None:
    table = five.copy()
    table.loc[table["left"] == "c", "response"] = 1
    table.loc[table["right"] == "c", "response"] = 5
    found = results(tmp_path, table)
    fitted = found.bradley_terry.of_set(None)["emotion"]

    assert "c never lost" in fitted.remark
    assert [fit.worst for fit in fitted.conditions if fit.condition == "c"] == [1]
    for contrast in found.contrasts:
        swept = "c" in (contrast.a, contrast.b)
        assert contrast.by == ("sign" if swept else "wald")
        assert math.isnan(contrast.low) == swept
        if swept:
            assert contrast.p_value == pytest.approx(2 * 0.5**10)


def test_raters_prefer_own_speech_if_the_motion_shows_it(tmp_path: Path) -> None:
    table = mismatch_table()
    result = report_of(table, "mismatch", tmp_path).results
    assert isinstance(result, MismatchResults)

    truth, static = result.conditions
    own = table[table["condition"] == "truth"]
    towards = np.where(own["right_speech"] == "own", 1, -1) * (own["response"] - 3)
    assert truth.counts["own_strong"] == (towards == 2).sum()
    assert truth.win_share.estimate == pytest.approx(((np.sign(towards) + 1) / 2).mean())
    assert truth.clmm.estimate > static.clmm.estimate
    assert truth.decision.p_holm == pytest.approx(min(1, 2 * truth.decision.p_value))
    assert set(truth.share) == {"own", "other", "equal"}
    bias = result.side_bias.of_set(None)["fits"]
    assert bias.on_left == pytest.approx((table["left_speech"] == "own").mean())


def test_practice_trials_are_paired_with_their_own_repeats() -> None:
    rows = [
        ("p1", "practice", "s1", 0, 2),
        ("p1", "practice", "s1", 0, 1),
        ("p1", "practice", "s2", 0, 2),
        ("p1", "main", "s3", 0, 0),
        ("p1", "repeat", "s2", 0, -2),
        ("p1", "repeat", "s1", 0, 1),
        ("p1", "repeat", "s1", 0, -1),
        ("p2", "practice", "s1", 0, 0),
        ("p2", "repeat", "s1", 1, 0),
    ]
    answers = pd.DataFrame(rows, columns=["participant", "kind", "segment", "condition", "value"])
    named = answers.astype(dict.fromkeys(("participant", "segment", "condition"), "category"))

    result = retest_of(named)

    assert (result.n, result.participants, result.equal_share) == (2, 1, 0.5)
