from pathlib import Path

from tests.studyapp.conftest import OwnStudy
from tests.support.command_line import run
from tests.support.studies.answered_study import answer_study


def test_a_backup_is_described_and_restored_with_what_it_lacks(
    own_study: OwnStudy, tmp_path: Path
) -> None:
    study = own_study("pairwise").root
    answer_study(study, people=1, stop_after=2)
    archive = tmp_path / "out.zip"

    output = run("backup", study, archive)
    assert "Backed up 1 participant with 2 answers" in output
    assert f"from sqlite:///{study / 'responses.db'}" in output
    assert "--with-media includes them" in output
    assert "Keep it as safe as the answers" in output
    output = run("restore", archive, tmp_path / "new")
    assert "Restored 1 participant with 2 answers" in output
    assert "'motionjury check' names" in output
    assert "Participants who were erased or withdrew after" in output
