from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from studyapp.study.study_file import new_study
from tests.analysis.results.made_tables import ranking_table
from tests.support.command_line import run

SMALL = ("--participants", "6,12", "--items", "5", "--effect", "0.8", "--processes", "1")


@pytest.fixture
def study(tmp_path: Path) -> Callable[[str], Path]:
    """Return a function that makes a study of a template."""

    def make(template: str) -> Path:
        path = tmp_path / template / "study.toml"
        new_study(path, template=template, name="planned")
        return path.parent

    return make


def test_every_size_has_its_power_and_cost(study: Callable[[str], Path]) -> None:
    folder = study("pairwise")
    out = folder / "plan"

    output = run("plan", folder, *SMALL, "--pay", 2)

    assert "6 x 5" in output
    # Its own size is not among those that are tried.
    assert "that a study with 25 participants and 5 segments finds" in output
    table = pd.read_csv(out / "power.csv")
    assert table["participants"].tolist() == [6, 12]
    assert table["power"].between(0, 1).all()
    assert table["cost"].tolist() == [12, 24]
    for ending in ("png", "svg", "pdf"):
        assert (out / f"power.{ending}").stat().st_size > 1000


def test_a_pilot_says_how_much_opinions_differ(
    study: Callable[[str], Path], tmp_path: Path
) -> None:
    pilot = tmp_path / "pilot.csv"
    ranking_table(participants=8, segments=6).to_csv(pilot, index=False)

    said = run("plan", study("ranking"), *SMALL, "--participants", 6, "--pilot", pilot)

    assert "Estimated from" in said
    assert "8 participants about 6 segments in pilot.csv" in said
    assert "its spreads are rough" in said
