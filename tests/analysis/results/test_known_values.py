import math
from dataclasses import replace
from pathlib import Path

import pytest

from analysis.results.conditions import RankingResults
from analysis.results.known_values import KnownValue, match_differences
from tests.analysis.results.made_tables import ranking_table, report_of


@pytest.mark.parametrize("family", ["all", "primary=ours,static"])
def test_ranks_are_told_apart_by_the_deciding_test_and_differ_in_the_unit_of_the_truth(
    family: str, tmp_path: Path
) -> None:
    table = ranking_table(participants=12, segments=8)
    report = report_of(table, "ranking", tmp_path, family=family)
    assert isinstance(report.results, RankingResults)
    known = [
        KnownValue(
            about=each.condition,
            question=each.question,
            measure="mean_rank",
            value=each.mean_rank.estimate,
            on_these_segments=0.0,
        )
        for each in report.results.conditions
    ]

    differences = match_differences([report], known)

    assert len(differences) == len(report.results.contrasts) > 0
    for difference, contrast in zip(differences, report.results.contrasts, strict=True):
        assert difference.estimate.estimate == pytest.approx(difference.truth)
        # Outside the family nothing is corrected.
        p = contrast.p_value if math.isnan(contrast.p_holm) else contrast.p_holm
        assert difference.decided is bool(p < 0.05)
    for turn, decided, undecided in (
        (1, "right", "undecided"),
        (-1, "wrong", "undecided"),
        (0, "wrong", "equal"),
    ):
        turned = [replace(each, value=turn * each.value) for each in known]
        signs = {difference.sign for difference in match_differences([report], turned)}
        assert decided in signs <= {decided, undecided}
