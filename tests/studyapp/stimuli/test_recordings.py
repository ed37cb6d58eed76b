from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats import read_clip
from motion.formats.beat_tracks import SemanticSpan, read_semantic_scores, write_arkit_json
from motion.segment import write_segments
from studyapp.results.export.shared_folder import copy_study
from studyapp.stimuli.recordings import RecordingFacts, Take, import_clips, import_take
from studyapp.study.folder import StudyFolder

MakeTake = Callable[..., Take]


def files_in(folder: StudyFolder) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.root.rglob("*") if path.is_file()}


def test_a_take_becomes_segments_with_speech_motion_and_condition(
    folder: StudyFolder, take: MakeTake
) -> None:
    segments, notes = import_take(folder, take())
    assert [s.name for s in segments] == ["take_01", "take_02", "take_03"]
    assert [(s.start, s.end) for s in segments] == [(0, 2), (2, 4), (4, 6)]
    assert list(folder.segments()) == segments
    clips = [read_clip(folder.clip("ground_truth", s.name)) for s in segments]
    assert [len(clip) for clip in clips] == [60, 60, 60]
    middle = np.linspace(0, -1, 180)[60:120]
    np.testing.assert_allclose(clips[1].poses[:, 16, 2], middle, atol=1e-5)
    assert "ground_truth" in folder.study().conditions
    assert any("condition 'ground_truth' added" in note for note in notes)


def test_lengths_up_to_a_second_apart_are_cut_to_the_common_part(
    folder: StudyFolder, take: MakeTake
) -> None:
    segments, notes = import_take(folder, take(speech=6.9, motion=6.0))
    assert len(segments) == 3
    assert any("6.90 s" in note and "cut to the common 6.00 s" in note for note in notes)


def test_importing_the_same_take_again_changes_nothing(folder: StudyFolder, take: MakeTake) -> None:
    segments, _ = import_take(folder, take())
    before = files_in(folder)
    assert import_take(folder, take()) == (segments, [])
    assert files_in(folder) == before


@pytest.mark.parametrize(
    ("recorded", "condition", "error"),
    [
        ({"speech": 8.0}, "ours", "the motion lasts 6.00 s, the speech 8.00 s"),
        ({"speech": 1.5, "motion": 1.5}, "ours", "too short for a segment"),
        ({"name": "my take"}, "ours", r"my take\.wav: 'my take' is not a usable segment name"),
        ({}, "../x", "condition name"),
        ({}, "broken", "motion of 'broken' is made by the generator"),
        ({"segment": 3.0}, "known", "exists with other times"),
        ({"speech": 6.2}, "known", r"speech/take\.wav: another recording"),
        ({"motion": 6.4}, "known", "already has other motion for segment take_01"),
    ],
)
def test_a_refused_take_changes_nothing(
    folder: StudyFolder, take: MakeTake, recorded: dict[str, Any], condition: str, error: str
) -> None:
    if condition == "known":
        import_take(folder, replace(take(), condition="known"))
    before = files_in(folder)
    with pytest.raises(InputError, match=error):
        import_take(folder, replace(take(**recorded), condition=condition))
    assert files_in(folder) == before


@pytest.mark.parametrize(
    ("names", "seconds", "condition", "error"),
    [
        (["take_02", "take_01"], 2.2, "ours", "differ by 0.1 s"),
        (["take_02", "take_99"], 2.0, "ours", "there is no segment 'take_99'"),
        (["take_02", "take_02"], 2.0, "ours", "two of the files have the name 'take_02'"),
        (["take_02"], 2.0, "ground_truth", "already has other motion for segment take_02"),
    ],
)
def test_refused_motion_changes_nothing(
    folder: StudyFolder,
    take: MakeTake,
    motion_file: Callable[..., Path],
    names: list[str],
    seconds: float,
    condition: str,
    error: str,
) -> None:
    import_take(folder, take())
    before = files_in(folder)
    motions = [motion_file(seconds, name=name) for name in names]
    with pytest.raises(InputError, match=error):
        import_clips(folder, motions, condition, RecordingFacts())
    assert files_in(folder) == before


def test_cutting_before_import_does_not_change_placement(
    folder: StudyFolder, take: MakeTake, tmp_path: Path
) -> None:
    """Position and orientation would reveal how a condition was imported."""
    poses = np.zeros((180, 165))
    poses[:, 1] = np.linspace(0, 1, 180)
    trans = np.linspace((0, 0, 0), (1, 0.2, 2), 180)
    walk, piece = tmp_path / "walk.npz", tmp_path / "take_01.npz"
    np.savez(walk, poses=poses, trans=trans, mocap_frame_rate=30)
    np.savez(piece, poses=poses[:60], trans=trans[:60], mocap_frame_rate=30)

    import_take(folder, replace(take(), motion=walk))
    import_clips(folder, [piece], "ours", RecordingFacts())

    here, before = (read_clip(folder.clip(name, "take_01")) for name in ("ground_truth", "ours"))
    np.testing.assert_allclose(here.poses, before.poses, atol=1e-5)
    np.testing.assert_allclose(here.trans, before.trans, atol=1e-5)


def test_a_face_in_a_companion_file_is_imported_and_other_json_is_ignored(
    folder: StudyFolder, take: MakeTake
) -> None:
    recording = take()
    assert recording.motion is not None
    recording.motion.with_suffix(".json").write_text('{"take": 3}')
    segments, notes = import_take(folder, replace(recording, condition="still"))
    assert any("motion.json, next to motion.npz, is left out" in note for note in notes)
    assert read_clip(folder.clip("still", segments[0].name)).arkit is None
    weights = np.linspace(0, 1, 300)[:, None] * np.ones(51)
    write_arkit_json(recording.motion.with_suffix(".json"), weights, 60)
    segments, notes = import_take(folder, recording)
    assert any("is from motion.json and stays still for the last 1.0 s" in note for note in notes)
    faces = [read_clip(folder.clip("ground_truth", s.name)).arkit for s in segments]
    first, last = faces[0], faces[2]
    assert first is not None
    assert last is not None
    np.testing.assert_allclose(first[:60, 0], np.linspace(0, 1, 300)[:120:2], atol=1e-3)
    # The face lasts five of the six seconds, and its last frame is held.
    np.testing.assert_allclose(last[-30:, :51], 1, atol=5e-3)
    np.testing.assert_array_equal(last[:, 51], 0)


def write_companion(take: Take, ending: str, text: str) -> Path:
    assert take.motion is not None
    path = take.motion.with_suffix(ending)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("segment", "ending", "text", "transcripts"),
    [
        (None, ".lab", "Good morning,\neverybody.\n", ["Good morning, everybody."]),
        (2.0, ".csv", "word,start,end\nGood,0.5,0.9\nall,4.1,4.5\n", ["good", "", "all"]),
    ],
)
def test_each_segment_gets_its_own_words(
    folder: StudyFolder,
    take: MakeTake,
    segment: float | None,
    ending: str,
    text: str,
    transcripts: list[str],
) -> None:
    recorded = take(segment=segment)
    write_companion(recorded, ending, text)
    segments, notes = import_take(folder, recorded)
    assert [each.transcript for each in segments] == transcripts
    assert list(folder.segments()) == segments
    assert f"motion.npz: the transcript is from motion{ending}" in notes


def test_a_transcript_of_other_speech_is_left_out(folder: StudyFolder, take: MakeTake) -> None:
    recorded = take()
    write_companion(recorded, ".csv", "word,start,end\nlate,50,51\n")
    segments, notes = import_take(folder, recorded)
    assert not any(each.transcript for each in segments)
    assert any("motion.csv, beside motion.npz, is left out" in note for note in notes)


def test_existing_transcripts_are_kept(folder: StudyFolder, take: MakeTake) -> None:
    first = take(segment=None)
    (segment,), _ = import_take(folder, first)
    write_segments(folder.speech, [replace(segment, transcript="Known.")])
    import_take(folder, replace(first, condition="ours"))
    assert [segment.transcript for segment in folder.segments()] == ["Known."]


def test_semantic_scores_are_imported_and_used_by_metrics(
    folder: StudyFolder, take: MakeTake
) -> None:
    cut = take()
    write_companion(cut, ".txt", "beat\t1.500\t2.500\t1.000\t0.700\t\n")
    import_take(folder, cut)
    assert read_semantic_scores(folder.semantics("take_01")) == (
        SemanticSpan(start=1.5, end=2, score=0.7),
    )
    assert read_semantic_scores(folder.semantics("take_02")) == (
        SemanticSpan(start=0, end=0.5, score=0.7),
    )
    assert read_semantic_scores(folder.semantics("take_03")) == ()
    copied = StudyFolder(folder.root.with_name("copied"))
    copy_study(folder, folder.study(), copied, videos=False)
    assert copied.semantics("take_01").read_text() == folder.semantics("take_01").read_text()
