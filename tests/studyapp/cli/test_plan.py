from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from studyapp.study.study_file import new_study
from tests.analysis.results.made_tables import ranking_table
from tests.studyapp.command_line import run

SMALL = (
    *("--participants", "6,12", "--items", "5", "--effect", "0.8"),
    *("--processes", "1", "--precision", "0.1"),
)


def test_a_study_without_a_folder_is_planned(tmp_path: Path) -> None:
    out = tmp_path / "out"

    said = run("plan", "--protocol", "pairwise", *SMALL, "--pay", 2, "--out", out)

    assert "6 x 5" in said
    assert "0% of the participants are excluded" in said
    table = pd.read_csv(out / "power.csv")
    assert table["participants"].tolist() == [6, 12]
    assert table["cost"].tolist() == [12, 24]
    assert table["power"].between(0, 1).all()
    for ending in ("png", "svg", "pdf"):
        assert (out / f"power.{ending}").stat().st_size > 1000


def test_a_study_is_planned_with_its_own_trials(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    new_study(path, template="rating", name="planned")
    text = path.read_text("utf-8")
    path.write_text(text.replace("[rehearsal]", "[rehearsal]\nparticipants_differ = 1.5", 1))

    said = run("plan", tmp_path, *SMALL, "--items", "5,6")

    document = json.loads((tmp_path / "plan" / "plan.json").read_text("utf-8"))
    assert document["protocol"] == "rating"
    assert document["assumed"]["excluded"] == 0.1
    assert "As the study file states: " in said
    assert "varies by 1.5 logits between participants and by 0.45 " in said
    assert {row["part"] for row in document["powers"]} == {"all", "timing"}


def test_a_pilot_says_how_much_opinions_differ(tmp_path: Path) -> None:
    pilot = tmp_path / "pilot.csv"
    ranking_table(participants=8, segments=6).to_csv(pilot, index=False)
    plan = ("plan", "--protocol", "ranking", *SMALL, "--out", tmp_path / "out")

    said = run(*plan, "--pilot", pilot)

    assert "Estimated from" in said
    assert "8 participants about 6 segments in pilot.csv" in said
    assert "its spreads are rough" in said


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ((), "nothing to plan"),
        (("--protocol", "pairwise", "--items", 4), "--participants is missing"),
        (("--protocol", "rating", *SMALL, "--test", "crossed_lmm"), "scores of pairs"),
        (
            ("--protocol", "pairwise", *SMALL, "--trials", 2, "--test", "crossed_lmm"),
            "judges every item once",
        ),
        (
            ("--protocol", "pairwise", "--participants", 90000, "--items", 100),
            "more than 400,000 answers",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(
    arguments: tuple[object, ...], why: str, tmp_path: Path
) -> None:
    assert why in run("plan", *arguments, "--out", tmp_path / "out", status=1)
