from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from studyapp.study.study_file import new_study
from tests.analysis.results.made_tables import ranking_table
from tests.support.command_line import run

SMALL = ("--participants", "6,12", "--items", "5", "--effect", "0.8", "--processes", "1")


@pytest.fixture
def study(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that makes a study of a template, with more under `[rehearsal]`."""

    def make(template: str = "pairwise", more: str = "") -> Path:
        path = tmp_path / template / "study.toml"
        new_study(path, template=template, name="planned")
        path.write_text(path.read_text("utf-8").replace("[rehearsal]", f"[rehearsal]{more}", 1))
        return path.parent

    return make


def test_every_size_gets_its_power_and_its_cost(study: Callable[..., Path]) -> None:
    folder = study()
    out = folder / "plan"

    output = run("plan", folder, *SMALL, "--pay", 2)

    assert "6 x 5" in output
    table = pd.read_csv(out / "power.csv")
    assert table["participants"].tolist() == [6, 12]
    assert table["power"].between(0, 1).all()
    assert table["cost"].tolist() == [12, 24]
    for ending in ("png", "svg", "pdf"):
        assert (out / f"power.{ending}").stat().st_size > 1000


def test_a_study_is_planned_with_its_own_trials(study: Callable[..., Path]) -> None:
    folder = study("rating", "\nparticipants_differ = 1.5")

    said = run("plan", folder, *SMALL, "--items", "5,6")

    document = json.loads((folder / "plan" / "plan.json").read_text("utf-8"))
    assert document["protocol"] == "rating"
    assert document["assumed"]["excluded"] == 0.1
    assert "As the study file states: " in said
    assert "varies by 1.5 logits between participants and by 0.45 " in said
    assert {row["part"] for row in document["powers"]} == {"all", "timing"}


def test_a_pilot_says_how_much_opinions_differ(study: Callable[..., Path], tmp_path: Path) -> None:
    pilot = tmp_path / "pilot.csv"
    ranking_table(participants=8, segments=6).to_csv(pilot, index=False)

    said = run("plan", study("ranking"), *SMALL, "--participants", 6, "--pilot", pilot)

    assert "Estimated from" in said
    assert "8 participants about 6 segments in pilot.csv" in said
    assert "its spreads are rough" in said
