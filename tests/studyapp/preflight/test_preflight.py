from __future__ import annotations

import shutil
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from studyapp.preflight.check import check
from studyapp.preflight.finding import SEVERITIES, Finding, Severity
from studyapp.results.analysed_tasks import study_notes
from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from studyapp.study.media import PairVideo, Stimuli, read_stimuli, write_stimuli
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.study_file import new_study
from tests.support.studies.edited_study import edited
from tests.support.studies.takes import write_motion, write_speech


def pretend_rendered(folder: StudyFolder, video: Path) -> None:
    """Put a copy of `video` where each pair video belongs."""
    study = folder.study()
    assert isinstance(study, PairwiseStudy)
    pairs = tuple(
        PairVideo(
            segment=segment.name,
            left=left,
            right=right,
            file=f"videos/{segment.name}-{left}-{right}.mp4",
            duration=segment.duration,
            key="k",
        )
        for segment in folder.segments()
        for left, right in study.pairs
    )
    for pair in pairs:
        path = folder.root / pair.file
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(video, path)
    write_stimuli(folder.stimuli, Stimuli(pairs=pairs))


@pytest.fixture(scope="module")
def video(tiny_study_template: Path) -> Path:
    """Return a video of two seconds, as long as the segments here."""
    return next((tiny_study_template / "videos").rglob("*.mp4"))


@pytest.fixture(scope="module")
def ready_once(video: Path, tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """Return a study with a recording, whose videos are there; tests take copies."""
    root = tmp_path_factory.mktemp("ready")
    folder = StudyFolder(root / "study")
    new_study(folder.definition, name="study", trials=2)
    import_take(
        folder,
        Take(
            motion=write_motion(root / "motion.npz", 6.0),
            speech=write_speech(root / "take.wav", 6.0),
            frame_rate=None,
            segment_seconds=2.0,
            condition="ground_truth",
            speaker="scott",
            emotion="neutral",
        ),
    )
    pretend_rendered(folder, video)
    return folder


@pytest.fixture(scope="module")
def untouched(ready_once: StudyFolder) -> list[Finding]:
    """Return what is found of the study as it is."""
    return check(ready_once)


@pytest.fixture
def ready(ready_once: StudyFolder, tmp_path: Path) -> StudyFolder:
    return StudyFolder(shutil.copytree(ready_once.root, tmp_path / "ready"))


def told(found: Iterable[Finding], severity: Severity) -> list[str]:
    return [finding.what for finding in found if finding.severity is severity]


def findings_of(folder: StudyFolder, severity: Severity) -> list[str]:
    return told(check(folder), severity)


def change(folder: StudyFolder, *keys: str, value: object) -> None:
    with edited(folder.definition) as document:
        table: object = document
        for key in keys[:-1]:
            table = table[key]  # type: ignore[index]
        table[keys[-1]] = value  # type: ignore[index]


def test_a_rendered_study_has_no_errors(untouched: list[Finding]) -> None:
    assert told(untouched, "error") == []


def test_each_missing_video_is_named_with_its_conditions_and_errors_come_first(
    ready: StudyFolder,
) -> None:
    pair = read_stimuli(ready.stimuli).pairs[3]
    (ready.root / pair.file).unlink()

    found = check(ready)

    severities = [finding.severity for finding in found]
    assert severities == sorted(severities, key=SEVERITIES.index)
    (error,) = told(found, "error")
    assert repr(pair.left) in error
    assert repr(pair.right) in error
    assert pair.segment in error


def test_missing_speech_is_named(ready: StudyFolder) -> None:
    (ready.speech / "take.wav").unlink()
    (found,) = [each for each in check(ready) if each.severity == "error"]
    assert found.name == "speech-unreadable"
    assert found.where.endswith("segments.csv, line 2")
    assert "take.wav" in found.what


def test_a_video_of_another_length_than_its_speech_is_an_error(ready: StudyFolder) -> None:
    stimuli = read_stimuli(ready.stimuli)
    first = stimuli.pairs[0].model_copy(update={"duration": 9.0})
    write_stimuli(ready.stimuli, Stimuli(pairs=(first, *stimuli.pairs[1:])))
    (error,) = findings_of(ready, "error")
    assert "lasts 9 s" in error


EXCLUDED = "left out of the analysis, in this order: "
COVERAGE = {"catch.trials": 0, "exclusions": [{"rule": "coverage", "below": 0.9}]}
ENGLISH = (
    "the pages are in the language 'ja', but title, page.consent, the question 'synchronisation' "
    "and the question 'emotion' still say what the English template says"
)
REPEATED = " of 3 catch trials and attention checks have speech that comes in another trial too"


@pytest.mark.parametrize(
    ("severity", "said", "keys"),
    [
        ("note", "3 segments of neutral allow 3 pairs", {"trials": 24}),
        ("note", "3 pairs instead of 24", {"trials": 24}),
        ("warning", "'ground_truth' has 30 frames per second", {"video.frame_rate": 60}),
        ("warning", ENGLISH, {"page.language": "ja"}),
        ("warning", "neither catch trials", {"catch.trials": 0}),
        ("warning", "can leave nobody out", COVERAGE),
        ("note", f"{EXCLUDED}nobody", {"catch.trials": 0, "exclusions": []}),
        (
            "note",
            f"{EXCLUDED}1. who gave at least 50% of the answers in less than 8 s "
            "(time<8,share=0.5); 2. who did not finish (incomplete)",
            {
                "catch.trials": 0,
                "exclusions": [{"rule": "time", "below": 8}, {"rule": "incomplete"}],
            },
        ),
    ],
)
def test_what_the_study_file_says_is_held_against_what_there_is(
    ready: StudyFolder,
    untouched: list[Finding],
    severity: Severity,
    said: str,
    keys: dict[str, object],
) -> None:
    assert not any(said in what for what in told(untouched, severity))
    for key, value in keys.items():
        change(ready, *key.split("."), value=value)
    assert any(said in what for what in findings_of(ready, severity))


def test_what_is_told_of_the_study_as_it_is_goes_once_the_study_file_says_otherwise(
    ready: StudyFolder, untouched: list[Finding]
) -> None:
    before, nobody = told(untouched, "warning"), "participants have nobody to ask"
    assert nobody in before
    # Two of three segments are heard in pairs, so that one is left for a catch trial.
    assert any(note.startswith(f"2{REPEATED}") for note in told(untouched, "note"))
    for said in ("published design has 24", "say nothing about happiness"):
        assert any(said in note for note in told(untouched, "note"))
    assert (
        f"{EXCLUDED}1. who did not finish (incomplete); 2. who failed more than 1 catch trial "
        "(catch>1)" in told(untouched, "note")
    )
    change(ready, "page", "contact", value="lab@example.org")
    change(ready, "catch", "trials", value=1)
    change(ready, "exclusions", value=[{"rule": "coverage", "below": 0.99}])

    found = check(ready)

    assert nobody not in told(found, "warning")
    assert not any("in another trial too" in note for note in told(found, "note"))
    assert not any("leave nobody" in warning for warning in told(found, "warning"))


def test_a_channel_that_only_some_conditions_move_is_warned_of_until_it_is_frozen(
    ready: StudyFolder,
) -> None:
    generate(ready)
    change(ready, "freeze", value=[])
    said = "face never moves in ground_truth"
    assert any(said in warning for warning in findings_of(ready, "warning"))
    change(ready, "freeze", value=["face", "hands", "root", "lower_body"])
    assert not any("never moves" in w for w in findings_of(ready, "warning"))


def test_a_study_without_a_recording_says_what_its_catch_trials_show(
    ready: StudyFolder, video: Path
) -> None:
    assert study_notes(ready.study()) == ()
    with edited(ready.definition) as document:
        del document["conditions"]["ground_truth"]
    (note,) = study_notes(ready.study())
    assert "rule_based against broken" in note
    pretend_rendered(ready, video)
    assert note.rstrip(".") in findings_of(ready, "note")


@pytest.mark.parametrize(
    ("framing", "avatar", "freeze", "said"),
    [
        ("face", "alex", ["face"], "framed on the face, but freeze holds it still"),
        ("face", "mannequin", [], "framed on the face, but the study's body has no face"),
        ("hands", "alex", ["hands"], "framed on the hands, but freeze holds it still"),
        ("hands", "alex", ["face"], ""),
        ("face", "alex", ["hands"], ""),
        ("upper_body", "mannequin", ["face", "hands"], ""),
    ],
)
def test_a_framing_of_what_stays_still_is_warned_of(
    ready: StudyFolder, framing: str, avatar: str, freeze: list[str], said: str
) -> None:
    with edited(ready.definition) as document:
        document["video"].update({"framing": framing, "avatar": avatar})
        document["freeze"] = freeze
    found = [warning for warning in findings_of(ready, "warning") if "framed on" in warning]
    assert found == ([f"the videos are {said}"] if said else [])


def test_a_face_that_is_asked_about_but_small_is_noted(ready: StudyFolder) -> None:
    with edited(ready.definition) as document:
        document["video"].update({"size": 240})
        document["freeze"] = []
        document["questions"][1]["text"] = "Which face fits better?"
    said = "the question 'emotion' is about the face, but a head is only"
    assert sum(said in note for note in findings_of(ready, "note")) == 1
    change(ready, "video", "framing", value="face")
    assert not any(said in note for note in findings_of(ready, "note"))


def test_a_background_that_pages_do_not_have_is_noted(ready: StudyFolder) -> None:
    said = "another background than participants' pages"
    assert not any(said in note for note in findings_of(ready, "note"))
    change(ready, "video", "background", value="#2e3440")
    assert any(said in note for note in findings_of(ready, "note"))


def test_every_broken_clip_is_an_error_beside_all_other_findings(
    ready: StudyFolder, untouched: list[Finding]
) -> None:
    segments = [segment.name for segment in ready.segments()][:2]
    for condition, segment in zip(("ground_truth", "broken"), segments, strict=True):
        path = ready.clip(condition, segment)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("torn")
    found = check(ready)
    assert [each.where for each in found if each.name == "motion-unreadable"] == [
        f"motion/ground_truth/{segments[0]}.npz",
        f"motion/broken/{segments[1]}.npz",
    ]
    assert len(told(found, "error")) == 2
    assert told(found, "warning") == told(untouched, "warning")


def test_a_broken_expression_matrix_is_an_error(ready: StudyFolder) -> None:
    np.save(ready.root / "face.npy", np.ones((3, 3)))
    change(ready, "video", "expression_matrix", value="face.npy")
    (found,) = [each for each in check(ready) if each.severity == "error"]
    assert found.name == "body-unusable"
    assert "face.npy" in found.where
