import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from motion.errors import InputError
from studyapp.results.answers import read_answers
from studyapp.results.export.shared_folder import copy_study
from studyapp.results.export.sharing import share
from studyapp.results.export.tables import export
from studyapp.results.report import report
from studyapp.study.folder import StudyFolder
from tests.studyapp.results.conftest import with_motion
from tests.studyapp.results.export.people import FORMULA, NAMES, secrets_of, text_of
from tests.support.studies.taking_part_steps import taking_part

Answered = Callable[[str], StudyFolder]


@pytest.fixture(scope="module")
def passed_on(
    recruited_once: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> tuple[StudyFolder, Path]:
    """Return a study, and a folder for another lab that tests do not change."""
    root = tmp_path_factory.mktemp("passed-on")
    folder = StudyFolder(root / "study")
    shutil.copytree(recruited_once("pairwise"), folder.root)
    share(folder, root / "out")
    return folder, root / "out"


def files_of(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def test_another_lab_repeats_the_results_byte_for_byte(answered: Answered, tmp_path: Path) -> None:
    folder = answered("mismatch")
    here = report(folder).with_name("results.json").read_bytes()
    share(folder, tmp_path / "out")
    shutil.move(tmp_path / "out", tmp_path / "elsewhere")
    shutil.rmtree(folder.root)

    there = report(StudyFolder(tmp_path / "elsewhere" / "sourcedata" / "study"))

    assert there.with_name("results.json").read_bytes() == here
    assert (tmp_path / "elsewhere" / "sourcedata" / "results.json").read_bytes() == here
    assert json.loads(here)["participants"]["recruited"] == 2


def test_a_shared_folder_identifies_nobody(
    passed_on: tuple[StudyFolder, Path], tmp_path: Path
) -> None:
    folder, out = passed_on

    text = text_of(files_of(out))
    assert {name for name in (*NAMES, *secrets_of(folder)) if name in text} == set()
    assert FORMULA not in text
    # The time of participation could identify a person.
    assert not re.search(r"20\d\d-\d\d-\d\dT", text)
    share(folder, tmp_path / "with", free_text=True)
    form = pd.read_csv(tmp_path / "with" / "phenotype" / "form.tsv", sep="\t")
    assert form["comment"].tolist()[2] == "'" + FORMULA


def test_the_folder_follows_bids_and_lists_every_video_with_its_checksum(
    passed_on: tuple[StudyFolder, Path],
) -> None:
    _, out = passed_on

    described = json.loads((out / "dataset_description.json").read_text("utf-8"))
    assert {"Name", "BIDSVersion", "DatasetType", "GeneratedBy"} <= set(described)
    people = pd.read_csv(out / "participants.tsv", sep="\t", keep_default_na=False)
    assert next(iter(people.columns)) == "participant_id"
    folders = [path.name for path in sorted(out.glob("sub-*"))]
    assert folders == sorted(people["participant_id"]) and len(folders) == 3
    allowed = {"README.md", "dataset_description.json", "participants.tsv", "participants.json"}
    allowed |= {"phenotype", "sourcedata", "task-finished_beh.json"}
    assert {path.name for path in out.iterdir()} == allowed | set(folders)
    sidecars = {"participants.tsv": out / "participants.json"}
    sidecars |= {
        str(path.relative_to(out)): out / "task-finished_beh.json" for path in out.glob("sub-*/*/*")
    }
    sidecars["phenotype/form.tsv"] = out / "phenotype" / "form.json"
    sidecars["sourcedata/watching.tsv"] = out / "sourcedata" / "watching.json"
    for name, sidecar in sidecars.items():
        assert re.fullmatch(
            r"(sub-[a-z0-9]+/beh/sub-[a-z0-9]+_task-finished_beh|[a-z/]+)\.tsv", name
        )
        cells = pd.read_csv(out / name, sep="\t", dtype=str, keep_default_na=False)
        meanings = json.loads(sidecar.read_text("utf-8"))
        assert all(meanings[column]["Description"] for column in cells.columns)
        assert not (cells == "").any(axis=None), name
    assert len(sidecars) == 6
    stimuli = pd.read_csv(out / "sourcedata" / "stimuli.tsv", sep="\t")
    assert len(stimuli) and stimuli["sha256"].str.fullmatch("[0-9a-f]{64}").all()


def test_a_rehearsal_is_marked_and_the_read_me_names_files_that_are_there(
    answered_once: Callable[..., Path], passed_on: tuple[StudyFolder, Path], tmp_path: Path
) -> None:
    answered = answered_once("pairwise", people=1)
    folder = StudyFolder(Path(shutil.copytree(answered, tmp_path / "study")))
    folder.responses.rename(folder.rehearsal)
    folder.stimuli.unlink()

    share(folder, tmp_path / "out", rehearsal=True)
    export(folder, tmp_path / "answers.csv", rehearsal=True)

    pages = ("out/README.md", "out/sourcedata/codebook.md", "answers_codebook.md")
    assert all("no person answered" in (tmp_path / page).read_text("utf-8") for page in pages)
    assert "Answers of 1 participant of a" in (tmp_path / "out" / "README.md").read_text("utf-8")
    described = json.loads((tmp_path / "out" / "dataset_description.json").read_text("utf-8"))
    assert described["Name"].startswith("[rehearsal] ")
    for out in (tmp_path / "out", passed_on[1]):
        named = re.findall(r"^([a-zA-Z]\S+)  +[a-z]", (out / "README.md").read_text("utf-8"), re.M)
        assert len(named) > 5
        assert [name for name in named if not any(out.glob(name))] == []
    assert "no person answered" not in text_of(files_of(passed_on[1]))


def test_only_the_number_of_withdrawn_participants_is_shared(
    answered: Answered, tmp_path: Path
) -> None:
    folder = answered("pairwise")
    with taking_part(folder.root) as second:
        second.enrol("visit1").withdraw()

    done = share(folder, tmp_path / "out")

    assert done.participants == 2
    stored = read_answers(StudyFolder(done.study), "participants").stored
    assert stored is not None
    assert stored.study_sessions["withdrawn"].tolist() == [False, True, False]


def test_damaged_answers_are_refused(passed_on: tuple[StudyFolder, Path], tmp_path: Path) -> None:
    copy = StudyFolder(tmp_path)
    whole = StudyFolder(passed_on[1] / "sourcedata" / "study").shared_answers.read_bytes()
    middle = len(whole) // 2
    changed = bytes([whole[middle] ^ 1])
    for damaged in (whole[:-2], whole[:middle] + changed + whole[middle + 1 :], b""):
        copy.shared_answers.write_bytes(damaged)
        with pytest.raises(InputError, match="Get the folder again"):
            read_answers(copy, "participants")


def test_a_shared_folder_is_not_exported_again_and_holds_no_database(
    passed_on: tuple[StudyFolder, Path], tmp_path: Path
) -> None:
    copy = StudyFolder(passed_on[1] / "sourcedata" / "study")

    for again in (lambda: share(copy, tmp_path / "out"), lambda: export(copy, tmp_path / "a.csv")):
        with pytest.raises(InputError, match="comes from another lab"):
            again()
    assert list(tmp_path.iterdir()) == []
    both = StudyFolder(Path(shutil.copytree(copy.root, tmp_path / "both")))
    both.responses.touch()
    with pytest.raises(InputError, match="both a database and answers from another lab"):
        read_answers(both, "participants")


def test_nothing_is_overwritten_or_shared_without_a_participant(
    answered: Answered, finished_study: Callable[[str], Path], tmp_path: Path
) -> None:
    folder, out = answered("pairwise"), tmp_path / "out"
    out.mkdir()
    (out / "precious").write_text("mine")

    with pytest.raises(InputError, match="this folder is not empty"):
        share(folder, out)
    with pytest.raises(InputError, match="within the study"):
        share(folder, folder.root / "out")
    with pytest.raises(InputError, match="no database of answers yet"):
        share(StudyFolder(finished_study("rating")), tmp_path / "new")
    assert [path.name for path in out.iterdir()] == ["precious"]
    assert not (tmp_path / "new").exists()


LICENSED = '\n[video]\nbody = "licensed/smplx.npz"\nexpression_matrix = "{matrix}"\n'

MATERIAL = (
    "motion/rule_based/take-0.npz",
    "motion/broken/take-1.npz",
    "evaluators/emotion.safetensors",
    "matrix.npy",
)
"""Inputs of metrics except the speech."""

ELSE = ("responses.db", "pseudonyms.key", "report/results.json", "motion/unused/take-0.npz")


@pytest.fixture
def folder(tiny_study: Path) -> StudyFolder:
    for name in (*MATERIAL, *ELSE, "licensed/smplx.npz"):
        file = tiny_study / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(name.encode())
    return StudyFolder(tiny_study)


def copied(folder: StudyFolder, to: Path, matrix: str, *, videos: bool = False) -> list[str]:
    text = folder.definition.read_text("utf-8")
    folder.definition.write_text(text + LICENSED.format(matrix=matrix), "utf-8")
    return copy_study(folder, folder.study(), StudyFolder(to), videos=videos)


def names(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def test_only_files_that_metrics_need_are_copied(folder: StudyFolder, tmp_path: Path) -> None:
    remarks = copied(folder, tmp_path / "copy", "matrix.npy")

    speech = {"speech/segments.csv", "speech/take.wav"}
    assert names(tmp_path / "copy") == {"study.toml", "stimuli.json", *speech, *MATERIAL}
    for name in names(tmp_path / "copy"):
        assert (tmp_path / "copy" / name).read_bytes() == (folder.root / name).read_bytes()
    assert [remark.partition(". ")[0] for remark in remarks] == [
        "Not copied, as not part of the study: smplx.npz"
    ]


@pytest.mark.parametrize("videos", [True, False])
def test_motion_beside_finished_videos_is_copied_and_needs_the_videos(
    answered: Answered, tmp_path: Path, *, videos: bool
) -> None:
    folder = with_motion(answered("pairwise"), "ours", "theirs")
    shutil.rmtree(folder.speech)
    copy = StudyFolder(tmp_path / "copy")

    remarks = copy_study(folder, folder.study(), copy, videos=videos)

    assert any(name.startswith("motion/ours/") for name in names(copy.root))
    assert any("--with-videos" in remark for remark in remarks) is not videos


def test_files_outside_the_study_are_named_and_not_copied(
    folder: StudyFolder, tmp_path: Path
) -> None:
    (folder.root.parent / "outside.npy").write_bytes(b"x")

    remarks = copied(folder, tmp_path / "copy", "../outside.npy", videos=True)

    assert "not part of the study: smplx.npz and outside.npy" in remarks[0]
    assert "videos/pairs/000.mp4" in names(tmp_path / "copy")
