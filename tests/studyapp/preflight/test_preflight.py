"""`check` on a whole study."""

import shutil
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.formats import read_clip, write_clip
from renderer.look import default_body
from studyapp.preflight.check import check
from studyapp.preflight.design_checks import balance_findings
from studyapp.preflight.finding import SEVERITIES, Finding, Severity
from studyapp.preflight.material import Material
from studyapp.stimuli.rendering import equalise_sizes
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Stimuli, read_stimuli, write_stimuli
from studyapp.study.settings.study import Study
from studyapp.study.study_file import new_study
from tests.studyapp.conftest import OwnStudy
from tests.support.studies.made_study import make_segments, make_study
from tests.support.studies.redefining import set_keys
from tests.support.studies.takes import write_motion
from tests.support.studies.tiny_study import SECONDS


@pytest.fixture(scope="module")
def ready_once(tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """Return a study with its videos, and the motion of its reference."""
    root = tmp_path_factory.mktemp("ready") / "study"
    folder = StudyFolder(Path(shutil.copytree(tiny_study_template, root)))
    for segment in folder.segments():
        write_motion(folder.clip("rule_based", segment.name), SECONDS)
    equalise_sizes(folder)
    return folder


@pytest.fixture(scope="module")
def original(ready_once: StudyFolder) -> list[Finding]:
    """Return the findings of the study before a test changes it."""
    return check(ready_once)


@pytest.fixture
def ready(ready_once: StudyFolder, tmp_path: Path) -> StudyFolder:
    return StudyFolder(shutil.copytree(ready_once.root, tmp_path / "ready"))


def clauses(findings: Iterable[Finding], severity: Severity) -> list[str]:
    return [finding.what for finding in findings if finding.severity == severity]


def count(findings: Iterable[Finding], severity: Severity, words: str) -> int:
    return sum(words in clause for clause in clauses(findings, severity))


def test_a_missing_video_is_reported_with_its_conditions_and_errors_come_first(
    ready: StudyFolder,
) -> None:
    pair = read_stimuli(ready.stimuli).pairs[3]
    (ready.root / pair.file).unlink()

    findings = check(ready)

    severities = [finding.severity for finding in findings]
    assert severities == sorted(severities, key=SEVERITIES.index)
    (error,) = clauses(findings, "error")
    for word in (repr(pair.left), repr(pair.right), pair.segment):
        assert word in error


def test_overlong_videos_and_missing_speech_are_reported(ready: StudyFolder) -> None:
    first, *others = read_stimuli(ready.stimuli).pairs
    longer = first.model_copy(update={"duration": 9.0})
    write_stimuli(ready.stimuli, Stimuli(pairs=(longer, *others)))
    (error,) = clauses(check(ready), "error")
    assert "lasts 9 s" in error
    (ready.speech / "take.wav").unlink()
    (unreadable,) = [finding for finding in check(ready) if finding.severity == "error"]
    assert unreadable.name == "speech-unreadable"
    assert unreadable.where.endswith("segments.csv, line 2")
    assert "take.wav" in unreadable.what


EXCLUDED = "excluded from the analysis, in this order: "
FACELESS = {"video.framing": "face", "video.avatar": "mannequin"}
FAILED_CATCH = {"rule": "catch", "more_than": 3}
RULES = [{"rule": "time", "below": 8}, {"rule": "incomplete"}]
NUMBERED = (
    "1. who gave at least 50% of the answers in less than 8 s (time<8,share=0.5); "
    "2. who did not finish (incomplete)"
)


@pytest.mark.parametrize(
    ("severity", "words", "keys"),
    [
        ("note", "4 pairs instead of 24", {"trials": 24}),
        ("warning", "'rule_based' has 30 frames per second", {"video.frame_rate": 60}),
        ("warning", "nobody to contact", {"page.contact": ""}),
        ("warning", "neither catch trials", {"catch.trials": 0}),
        ("warning", "may fail 3 of 1 catch trials", {"exclusions": [FAILED_CATCH]}),
        ("note", f"{EXCLUDED}nobody", {"catch.trials": 0, "exclusions": []}),
        ("note", f"{EXCLUDED}{NUMBERED}", {"catch.trials": 0, "exclusions": RULES}),
        ("warning", "frame the hands, but", {"video.framing": "hands", "freeze": ["hands"]}),
        ("warning", "the study's body has no face", FACELESS),
        ("error", "not an expression matrix", {"video.expression_matrix": "face.npy"}),
    ],
)
def test_settings_are_compared_with_each_other_and_with_the_material(
    ready: StudyFolder,
    original: list[Finding],
    severity: Severity,
    words: str,
    keys: dict[str, object],
) -> None:
    assert count(original, severity, words) == 0
    set_keys(ready.definition, keys)
    assert count(check(ready), severity, words) == 1


def test_a_question_cannot_name_the_emotion_of_finished_videos(own_study: OwnStudy) -> None:
    folder = own_study("pairwise")
    assert count(check(folder), "warning", "say neutral") == 0
    set_keys(folder.definition, {"questions.0.text": "The speaker feels {emotion}. Which fits?"})
    assert count(check(folder), "warning", "say neutral in every trial") == 1


def test_the_design_is_told_in_notes(original: list[Finding]) -> None:
    excluded = (
        f"{EXCLUDED}1. who did not finish (incomplete); 2. who failed more than 1 catch trial "
        "(catch>1)"
    )
    catch = "catch trials show rule based against broken"
    assert clauses(original, "error") == []
    for words in ("published design has 24", "say nothing about", excluded, catch):
        assert count(original, "note", words) == 1


def test_a_channel_that_moves_in_only_some_conditions_is_reported_until_frozen(
    ready: StudyFolder,
) -> None:
    for segment in ready.segments():
        clip = read_clip(ready.clip("rule_based", segment.name))
        weights = np.random.default_rng(1).random((len(clip), 52), np.float32)
        write_clip(ready.clip("mismatched", segment.name), replace(clip, arkit=weights))
    assert count(check(ready), "warning", "face never moves in rule_based") == 1
    set_keys(ready.definition, {"freeze": ["face"]})
    assert count(check(ready), "warning", "never moves") == 0


def test_bodies_of_another_shape_in_some_conditions_are_reported(ready: StudyFolder) -> None:
    arrays = dict(np.load(default_body()))
    arrays["shapedirs"][:, :, :2] = 0.01
    np.savez(ready.root / "smplx.npz", **arrays)
    set_keys(ready.definition, {"video.body": "smplx.npz"})
    segments = [segment.name for segment in ready.segments()]
    thin, stout = [0.0, 1.0, 0.0], [0.0, -1.0]
    for others, reported in (([[0.0, 1.0], stout], 0), ([stout, thin], 1)):
        for condition, shapes in (("rule_based", [thin, stout]), ("mismatched", others)):
            for number, segment in enumerate(segments):
                clip = read_clip(ready.clip("rule_based", segment))
                shaped = replace(clip, betas=np.array(shapes[number % 2], np.float32))
                write_clip(ready.clip(condition, segment), shaped)
        findings = check(ready)
        assert count(findings, "warning", "bodies of mismatched have another shape") == reported


def test_every_broken_clip_is_an_error_among_other_findings(
    ready: StudyFolder, original: list[Finding]
) -> None:
    segments = [segment.name for segment in ready.segments()][:2]
    for condition, segment in zip(("rule_based", "broken"), segments, strict=True):
        path = ready.clip(condition, segment)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("torn")
    findings = check(ready)
    assert [f.where for f in findings if f.name == "motion-unreadable"] == [
        f"motion/rule_based/{segments[0]}.npz",
        f"motion/broken/{segments[1]}.npz",
    ]
    assert len(clauses(findings, "error")) == 2
    assert clauses(findings, "warning") == clauses(original, "warning")


def balance(study: Study, emotions: Sequence[str]) -> dict[str, str]:
    """Return the findings on the balance of a study whose segments have these emotions."""
    material = Material(
        folder=StudyFolder(Path()), study=study, segments=make_segments(emotions), media=None
    )
    return {finding.name: finding.what for finding in balance_findings(material)}


@pytest.mark.parametrize(
    ("emotions", "changes", "words", "unused"),
    [
        (["neutral", "anger"] * 2, {}, "50 planned participants judge each segment 50", ""),
        (["neutral"] * 3, {"comparisons": "adaptive"}, "chosen as answers arrive", ""),
        (["neutral"] * 99, {"trials": 1, "practice": 0}, "1 to 2 times", "segment-4 and 50 more"),
    ],
)
def test_judgements_of_segments_are_counted(
    emotions: list[str], changes: dict[str, Any], words: str, unused: str
) -> None:
    findings = balance(make_study(**changes), emotions)

    assert words in findings["balance"]
    assert ("segments-unused" in findings) == bool(unused)
    assert unused in findings.get("segments-unused", "")


def test_a_block_that_no_segment_is_long_enough_for_is_named(tmp_path: Path) -> None:
    study = new_study(tmp_path / "study.toml", template="ranking", name="short-speech")

    assert "no segment fits long," in balance(study, ["neutral"] * 12)["parts-unused"]
