from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from motion.errors import InputError
from studyapp.cli.report_command import command
from tests.analysis.results.made_tables import (
    catch_rows,
    pairwise_table,
    ranking_table,
    rating_table,
)


def run(*arguments: str) -> str:
    found = CliRunner().invoke(command, arguments, catch_exceptions=False)
    assert found.exit_code == 0, found.output
    return found.output


def test_a_table_is_reported_without_a_study(tmp_path: Path) -> None:
    table = tmp_path / "answers.csv"
    ranking_table(participants=4, segments=3).to_csv(table, index=False)
    out = tmp_path / "out"
    said = run("--responses", str(table), "--protocol", "ranking", "--out", str(out))
    assert str(out / "report.html") in said
    assert json.loads((out / "results.json").read_text("utf-8"))["protocol"] == "ranking"
    assert (out / "report.html").exists()
    assert (out / "tables" / "conditions.csv").exists()


@pytest.mark.parametrize(
    ("allowed", "excluded"), [([], True), (["--max-catch-failures", "2"], False)]
)
def test_the_rule_of_catch_trials_can_be_changed(
    allowed: list[str], excluded: bool, tmp_path: Path
) -> None:
    table = tmp_path / "answers.csv"
    catch_rows("p01", "lr", (3, 3)).to_csv(table, index=False)
    out = tmp_path / "out"
    run("--responses", str(table), "--protocol", "pairwise", "--out", str(out), *allowed)
    found = json.loads((out / "results.json").read_text("utf-8"))
    assert ("p01" in found["exclusions"]) == excluded


def test_rules_of_the_command_line_are_applied_last_and_marked_exploratory(tmp_path: Path) -> None:
    table = tmp_path / "answers.csv"
    answers = ranking_table(participants=4, segments=3)
    answers.assign(watched=np.where(answers["participant"] == "p02", 0.5, 1)).to_csv(
        table, index=False
    )
    out = tmp_path / "out"
    run(
        *("--responses", str(table), "--protocol", "ranking", "--out", str(out)),
        *("--exclude", "coverage<0.9", "--exclude", "time<3"),
    )
    found = json.loads((out / "results.json").read_text("utf-8"))
    assert found["exclusions"] == {"p02": "50 % of the videos watched"}
    assert [(one["rule"], one["reached"], one["removed"]) for one in found["rules"]] == [
        ("coverage", 4, 1),
        ("time", 3, 0),
    ]
    assert all(one["exploratory"] for one in found["rules"])
    assert found["rules"][1]["remark"] == "cannot be applied: how long answers took is not known"


def test_the_command_line_can_name_the_family_of_tests(tmp_path: Path) -> None:
    table, out = tmp_path / "answers.csv", tmp_path / "out"
    pairwise_table(participants=6, segments=4).to_csv(table, index=False)
    run(
        *("--responses", str(table), "--protocol", "pairwise", "--out", str(out)),
        *("--family", "primary=ours,other"),
    )
    found = json.loads((out / "results.json").read_text("utf-8"))
    corrected = [one["decision"]["p_holm"] is not None for one in found["comparisons"]]
    assert sorted(corrected) == [False, False, True]


@pytest.mark.parametrize(
    ("protocol", "arguments", "said"),
    [
        ("pairwise", ("--family", "against=nobody"), "names nobody"),
        ("pairwise", ("--scale", "1-5"), "is not a scale of a pairwise table"),
        ("rating", ("--scale", "5"), "is not a scale of a rating table"),
        ("rating", ("--scale", "2-5"), "on the scale from 2 to 5"),
    ],
)
def test_a_family_or_scale_that_does_not_fit_is_refused(
    protocol: str, arguments: tuple[str, str], said: str, tmp_path: Path
) -> None:
    table, out = tmp_path / "answers.csv", tmp_path / "out"
    made = pairwise_table if protocol == "pairwise" else rating_table
    made(participants=4, segments=3).to_csv(table, index=False)
    with pytest.raises(InputError, match=said):
        CliRunner().invoke(
            command,
            ["--responses", str(table), "--protocol", protocol, "--out", str(out), *arguments],
            catch_exceptions=False,
        )
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "there is nothing to report"),
        (["--responses", "a.csv", "--out", "out"], "--protocol is missing"),
        (["--responses", "a.csv", "--out", "o", "--protocol", "rating"], "no such file"),
    ],
)
def test_what_is_missing_is_said(arguments: list[str], said: str) -> None:
    with pytest.raises(InputError, match=said):
        CliRunner().invoke(command, arguments, catch_exceptions=False)


def test_a_study_and_a_table_at_once_are_refused(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text("", "utf-8")
    with pytest.raises(InputError, match="--out cannot be given with a study folder"):
        CliRunner().invoke(command, [str(tmp_path), "--out", "o"], catch_exceptions=False)
