from __future__ import annotations

from pathlib import Path

import pandas as pd

from studyapp.study.study_file import new_study
from tests.analysis.results.made_tables import pairwise_table
from tests.support.command_line import run

SMALL = ("--participants", "6,12", "--items", "5", "--effect", "0.8", "--processes", "1")


def test_every_size_has_its_power_by_the_spreads_of_a_pilot(tmp_path: Path) -> None:
    folder, pilot = tmp_path / "study", tmp_path / "pilot.csv"
    new_study(folder / "study.toml", template="pairwise", name="planned")
    pairwise_table(participants=8, segments=6).to_csv(pilot, index=False)

    output = run("plan", folder, *SMALL, "--pilot", pilot)

    assert "6 x 5" in output
    # Its own size is not among those that are tried.
    assert "that a study with 25 participants and 5 segments finds" in output
    assert "Estimated from" in output
    assert "8 participants about 6 segments in pilot.csv" in output
    assert "its spreads are rough" in output
    table = pd.read_csv(folder / "plan" / "power.csv")
    assert table["participants"].tolist() == [6, 12]
    assert table["power"].between(0, 1).all()
    for ending in ("png", "svg", "pdf"):
        assert (folder / "plan" / f"power.{ending}").stat().st_size > 1000
