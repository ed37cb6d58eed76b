from pathlib import Path

import pandas as pd

from studyapp.study.study_file import new_study
from tests.support.command_line import run
from tests.support.studies.redefining import redefine

SMALL = ("--participants", "6,12", "--items", "5", "--effect", "0.8")


def test_every_size_has_its_power_by_the_spreads_of_the_study_file(tmp_path: Path) -> None:
    folder = tmp_path / "study"
    new_study(folder / "study.toml", template="pairwise", name="planned")
    redefine(folder, ("[rehearsal]", "[rehearsal]\nparticipants_differ = 0.8"))

    output = run("plan", folder, *SMALL)

    assert "6 x 5" in output
    # Its own size is not among those that are tried.
    assert "that a study with 25 participants and 5 segments finds" in output
    assert "As the study file states: the difference of two conditions varies by 0.8" in output
    table = pd.read_csv(folder / "plan" / "power.csv")
    assert table["participants"].tolist() == [6, 12]
    assert table["power"].between(0, 1).all()
    for ending in ("png", "svg", "pdf"):
        assert (folder / "plan" / f"power.{ending}").stat().st_size > 1000
