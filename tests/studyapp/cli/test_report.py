import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.analysis.results.made_tables import pairwise_table, ranking_table, rating_table
from tests.support.command_line import run


@pytest.fixture(autouse=True)
def figures_on_the_page_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("analysis.report.page.FORMATS", {})


MADE = {"pairwise": pairwise_table, "ranking": ranking_table, "rating": rating_table}


def report(folder: Path, protocol: str, *options: str, status: int = 0) -> str:
    """Report a table of four participants, of whom p02 watched half of the videos."""
    table = MADE[protocol](participants=4, segments=3)
    table = table.assign(watched=np.where(table["participant"] == "p02", 0.5, 1))
    table.to_csv(folder / "answers.csv", index=False)
    given = ("--responses", folder / "answers.csv", "--protocol", protocol)
    return run("report", *given, "--out", folder / "out", *options, status=status)


def results(folder: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((folder / "out" / "results.json").read_text("utf-8"))
    return document


def test_a_table_is_reported_with_rules_that_are_marked_exploratory(tmp_path: Path) -> None:
    said = report(tmp_path, "ranking", "--exclude", "coverage<0.9", "--exclude", "time<3")

    assert str(tmp_path / "out" / "report.html") in said
    assert (tmp_path / "out" / "tables" / "conditions.csv").exists()
    document = results(tmp_path)
    assert document["protocol"] == "ranking"
    assert document["exclusions"] == {"p02": "50% of the videos watched"}
    assert [(rule["rule"], rule["removed"], rule["exploratory"]) for rule in document["rules"]] == [
        ("coverage", 1, True),
        ("time", 0, True),
    ]
    assert document["rules"][1]["remark"] == "cannot be applied: how long answers took is not known"


def test_margin_and_family_are_options_for_tables(tmp_path: Path) -> None:
    report(tmp_path, "pairwise", "--family", "primary=ours,other", "--margin", "0.1")

    document = results(tmp_path)
    corrected = [each["decision"]["p_holm"] is not None for each in document["comparisons"]]
    assert sorted(corrected) == [False, False, True]
    assert len(document["equivalence"]) == len(document["comparisons"])


@pytest.mark.parametrize(
    ("protocol", "arguments", "error"),
    [
        ("pairwise", ("--scale", "1-5"), "is not a scale of a pairwise table"),
        ("rating", ("--scale", "5"), "is not a scale of a rating table"),
        ("rating", ("--scale", "2-5"), "on the scale from 2 to 5"),
        # With such margins, any two conditions would be equivalent.
        ("pairwise", ("--margin", "0.5"), "does not matter, above 0 and below 0.5"),
        ("rating", ("--scale", "1-5", "--margin", "4"), "does not matter, above 0 and below 4"),
    ],
)
def test_a_family_scale_or_margin_that_does_not_fit_is_refused(
    protocol: str, arguments: tuple[str, ...], error: str, tmp_path: Path
) -> None:
    assert error in report(tmp_path, protocol, *arguments, status=1)
    assert not (tmp_path / "out").exists()
