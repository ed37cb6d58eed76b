from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest
from click.testing import CliRunner, Result

from motion.errors import InputError
from studyapp.cli.plan_command import command
from studyapp.study.study_file import new_study
from tests.analysis.results.made_tables import ranking_table

SMALL = (
    *("--participants", "6,12", "--items", "5", "--effect", "0.8"),
    *("--processes", "1", "--precision", "0.1"),
)


def run(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments, catch_exceptions=False)


def test_a_study_without_a_folder_is_planned(tmp_path: Path) -> None:
    out = tmp_path / "out"

    found = run("--protocol", "pairwise", *SMALL, "--pay", "2", "--out", str(out))

    assert found.exit_code == 0, found.output
    assert "6 x 5" in found.output
    assert "0% of the participants are excluded" in found.output
    table = pd.read_csv(out / "power.csv")
    assert table["participants"].tolist() == [6, 12]
    assert table["cost"].tolist() == [12, 24]
    assert table["power"].between(0, 1).all()
    for ending in ("png", "svg", "pdf"):
        assert (out / f"power.{ending}").stat().st_size > 1000


def test_a_study_is_planned_with_its_own_trials(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    new_study(path, template="rating", name="planned")
    stated = path.read_text("utf-8").replace(
        "[rehearsal]", "[rehearsal]\nparticipants_differ = 1.5", 1
    )
    path.write_text(stated, "utf-8")

    found = run(str(tmp_path), *SMALL, "--items", "5,6")

    assert found.exit_code == 0, found.output
    document = json.loads((tmp_path / "plan" / "plan.json").read_text("utf-8"))
    assert document["protocol"] == "rating"
    assert document["assumed"]["excluded"] == 0.1
    assert "As the study file states: " in found.output
    assert "varies by 1.5 logits between participants and by 0.45 " in found.output
    assert {row["part"] for row in document["powers"]} == {"all", "timing"}


def test_a_pilot_says_how_much_opinions_differ(tmp_path: Path) -> None:
    pilot = tmp_path / "pilot.csv"
    ranking_table(participants=8, segments=6).to_csv(pilot, index=False)
    plan = ("--protocol", "ranking", *SMALL, "--out", str(tmp_path / "out"))

    found = run(*plan, "--pilot", str(pilot))

    assert "Estimated from" in found.output
    assert "8 participants about 6 segments in pilot.csv" in found.output
    assert "its spreads are rough" in found.output


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ((), "nothing to plan"),
        (("--protocol", "pairwise", "--items", "4"), "--participants is missing"),
        (
            ("--protocol", "rating", *SMALL, "--test", "crossed_lmm"),
            "scores of pairs",
        ),
        (
            ("--protocol", "pairwise", *SMALL, "--trials", "2", "--test", "crossed_lmm"),
            "judges every item once",
        ),
        (
            ("--protocol", "pairwise", "--participants", "90000", "--items", "100"),
            "more than 400,000 answers",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(
    arguments: tuple[str, ...], why: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError) as refused:
        run(*arguments, "--out", str(tmp_path / "out"))

    assert why in str(refused.value)
    assert refused.value.remedy


@pytest.mark.parametrize("numbers", ["0", "3,x", "2.5", ""])
def test_numbers_that_are_none_are_refused(numbers: str) -> None:
    found = run("--protocol", "pairwise", "--participants", numbers, "--items", "4")

    assert found.exit_code == 2
    assert "--participants" in found.output


def test_a_folder_says_itself_what_study_it_is(tmp_path: Path) -> None:
    new_study(tmp_path / "study.toml", name="planned")

    with pytest.raises(InputError, match="--protocol cannot be given"):
        run(str(tmp_path), "--protocol", "rating")
