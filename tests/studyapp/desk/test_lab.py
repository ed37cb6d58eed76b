"""What is served of a desk's studies follows their files."""

from __future__ import annotations

from studyapp.desk.lab import Lab, LabStudy
from tests.support.studies.redefining import redefine

AGAIN = ("fit the rhythm of the speech better", "follow the speech better")


def first_question(study: LabStudy) -> str:
    served = study.served()
    assert served is not None
    return served.study.questions[0].text


def test_a_study_is_in_preparation_until_its_videos_exist(tiny: LabStudy) -> None:
    video = tiny.folder.videos / "pairs" / "003.mp4"
    away = tiny.folder.root / "003.mp4"
    video.rename(away)
    assert tiny.standing().state == "being made"
    assert tiny.application() is None
    away.rename(video)
    assert tiny.standing().state == "ready"
    assert tiny.application() is not None


def test_a_change_before_the_first_participant_is_served_at_once(tiny: LabStudy) -> None:
    before = tiny.application()
    redefine(tiny.folder.root, AGAIN)
    assert first_question(tiny).endswith("follow the speech better?")
    assert tiny.application() is not before


def test_participants_continue_with_the_old_study_if_a_file_is_invalid(tiny: LabStudy) -> None:
    before = tiny.application()
    redefine(tiny.folder.root, ("trials = 4", "trails = 4"))
    assert tiny.application() is before
    standing = tiny.standing()
    assert standing.state == "ready"
    assert standing.problem is not None
    redefine(tiny.folder.root, ("trails = 4", "trials = 4"))
    assert tiny.standing().problem is None


def test_another_process_waits_for_a_new_version_and_then_serves_it(
    lab: Lab, taken: LabStudy
) -> None:
    other = LabStudy(taken.folder.root, lab.database, lab.clock, "")
    redefine(taken.folder.root, AGAIN)
    assert first_question(taken).endswith("rhythm of the speech better?")
    assert other.standing().state == "changed"
    assert other.application() is None
    taken.begin_new_version()
    for study in (taken, other):
        assert first_question(study).endswith("follow the speech better?")
        assert study.standing().problem is None


def test_only_folders_of_studies_with_plain_names_are_studies(lab: Lab, tiny: LabStudy) -> None:
    for name in ("research", "static", "with space", ".hidden", "dot.ted"):
        (lab.folder / name).mkdir()
        (lab.folder / name / "study.toml").write_bytes(tiny.folder.definition.read_bytes())
    (lab.folder / "empty").mkdir()
    assert [each.name for each in lab.studies()] == ["tiny"]
    assert lab.study("../lab/tiny") is None
