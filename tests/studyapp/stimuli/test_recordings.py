from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats import read_clip
from motion.formats.beat_tracks import write_arkit_json
from studyapp.stimuli.recordings import Take, import_clips, import_take
from studyapp.study.folder import StudyFolder

MakeTake = Callable[..., Take]


def files_in(folder: StudyFolder) -> set[str]:
    return {str(p.relative_to(folder.root)) for p in folder.root.rglob("*") if p.is_file()}


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


def test_ends_up_to_a_second_apart_are_cut_to_the_common_part_and_said(
    folder: StudyFolder, take: MakeTake
) -> None:
    segments, notes = import_take(folder, take(speech=6.9, motion=6.0))
    assert len(segments) == 3
    assert any("6.90 s" in note and "cut to the common 6.00 s" in note for note in notes)


@pytest.mark.parametrize(
    ("lengths", "said"),
    [
        ({"speech": 8.0, "motion": 6.0}, "the motion lasts 6.00 s, the speech 8.00 s"),
        ({"speech": 1.5, "motion": 1.5}, "too short for a segment"),
    ],
)
def test_a_take_that_does_not_fit_writes_nothing(
    folder: StudyFolder, take: MakeTake, lengths: dict[str, float], said: str
) -> None:
    before = files_in(folder)
    with pytest.raises(InputError, match=said):
        import_take(folder, take(**lengths))
    assert files_in(folder) == before


def test_importing_the_same_take_again_changes_nothing(folder: StudyFolder, take: MakeTake) -> None:
    segments, _ = import_take(folder, take())
    before = {name: (folder.root / name).read_bytes() for name in files_in(folder)}
    assert import_take(folder, take()) == (segments, [])
    assert {name: (folder.root / name).read_bytes() for name in files_in(folder)} == before


def test_other_cuts_of_a_known_take_are_refused(folder: StudyFolder, take: MakeTake) -> None:
    import_take(folder, take())
    with pytest.raises(InputError, match="exists with other times"):
        import_take(folder, take(segment=3.0))


def test_motion_made_elsewhere_joins_by_its_file_name(
    folder: StudyFolder, take: MakeTake, motion_file: Callable[..., Path]
) -> None:
    import_take(folder, take())
    motions = [motion_file(2.0, frame_rate=15, name=s.name) for s in folder.segments()]
    import_clips(folder, motions, condition="our_model", frame_rate=None)
    assert "our_model" in folder.study().conditions
    assert read_clip(folder.clip("our_model", "take_02")).duration == pytest.approx(2.0)


def test_a_motion_is_placed_alike_cut_here_or_before(
    folder: StudyFolder, take: MakeTake, tmp_path: Path
) -> None:
    """Where somebody stands and looks would tell which way a condition came in."""
    poses = np.zeros((180, 165))
    poses[:, 1] = np.linspace(0, 1, 180)
    trans = np.linspace((0, 0, 0), (1, 0.2, 2), 180)
    walk, piece = tmp_path / "walk.npz", tmp_path / "take_01.npz"
    np.savez(walk, poses=poses, trans=trans, mocap_frame_rate=30)
    np.savez(piece, poses=poses[:60], trans=trans[:60], mocap_frame_rate=30)

    import_take(folder, replace(take(), motion=walk))
    import_clips(folder, [piece], condition="ours", frame_rate=None)

    here, before = (read_clip(folder.clip(name, "take_01")) for name in ("ground_truth", "ours"))
    np.testing.assert_allclose(here.poses, before.poses, atol=1e-5)
    np.testing.assert_allclose(here.trans, before.trans, atol=1e-5)


@pytest.mark.parametrize(
    ("seconds", "name", "said"),
    [(2.2, "take_01", "differ by 0.1 s"), (2.0, "take_99", "no segment is called 'take_99'")],
)
def test_motion_that_belongs_to_no_speech_is_refused(
    folder: StudyFolder,
    take: MakeTake,
    motion_file: Callable[..., Path],
    seconds: float,
    name: str,
    said: str,
) -> None:
    import_take(folder, take())
    before = files_in(folder)
    good = motion_file(2.0, name="take_02")
    with pytest.raises(InputError, match=said):
        import_clips(
            folder, [good, motion_file(seconds, name=name)], condition="x", frame_rate=None
        )
    assert files_in(folder) == before


@pytest.mark.parametrize("condition", ["../x", "a b", ""])
def test_an_unsafe_condition_name_is_refused(
    folder: StudyFolder, take: MakeTake, condition: str
) -> None:
    with pytest.raises(InputError, match="condition name"):
        import_take(folder, replace(take(), condition=condition))
    import_take(folder, take())
    motion = take().motion
    assert motion is not None
    with pytest.raises(InputError, match="condition name"):
        import_clips(folder, [motion], condition=condition, frame_rate=None)


def test_two_files_for_one_segment_are_refused(
    folder: StudyFolder, take: MakeTake, motion_file: Callable[..., Path], tmp_path: Path
) -> None:
    import_take(folder, take())
    one = motion_file(2.0, name="take_02")
    another = tmp_path / "other" / one.name
    another.parent.mkdir()
    another.write_bytes(one.read_bytes())
    before = files_in(folder)
    with pytest.raises(InputError, match="two of the files are called 'take_02'"):
        import_clips(folder, [one, another], condition="x", frame_rate=None)
    assert files_in(folder) == before


def test_the_real_take_gives_six_segments(folder: StudyFolder, shared_data: Path) -> None:
    take = Take(
        motion=shared_data / "2_scott_0_1_1.bvh",
        speech=shared_data / "2_scott_0_1_1.wav",
        frame_rate=15,
        segment_seconds=10,
        condition="ground_truth",
        speaker="scott",
        emotion="neutral",
    )
    segments, notes = import_take(folder, take)
    assert len(segments) == 6
    assert any("cut to the common 63.80 s" in note for note in notes)
    with pytest.raises(InputError, match="957"):
        import_take(folder, replace(take, frame_rate=None))


@pytest.mark.parametrize("condition", ["rule_based", "broken"])
def test_motion_for_a_generated_condition_is_refused(
    folder: StudyFolder, take: MakeTake, condition: str
) -> None:
    before = files_in(folder)

    with pytest.raises(InputError, match=f"motion of '{condition}' is made by the generator"):
        import_take(folder, replace(take(), condition=condition))
    assert files_in(folder) == before


def test_other_speech_under_a_known_name_is_refused(folder: StudyFolder, take: MakeTake) -> None:
    import_take(folder, take())
    stored = (folder.speech / "take.wav").read_bytes()

    with pytest.raises(InputError, match=r"speech/take\.wav: another recording"):
        import_take(folder, take(speech=6.2))
    assert (folder.speech / "take.wav").read_bytes() == stored


def test_another_motion_of_the_same_condition_and_speech_is_refused(
    folder: StudyFolder, take: MakeTake, tmp_path: Path
) -> None:
    import_take(folder, take())
    stored = folder.clip("ground_truth", "take_01")
    before = stored.read_bytes()
    poses, trans = np.zeros((180, 165)), np.zeros((180, 3))
    poses[:, 50] = np.linspace(0, 1, 180)
    whole, piece = tmp_path / "whole.npz", tmp_path / "take_01.npz"
    np.savez(whole, poses=poses, trans=trans, mocap_frame_rate=30)
    np.savez(piece, poses=poses[:60], trans=trans[:60], mocap_frame_rate=30)

    with pytest.raises(InputError, match="has another motion for segment take_01 already"):
        import_take(folder, replace(take(), motion=whole))
    with pytest.raises(InputError, match="has another motion for segment take_01 already"):
        import_clips(folder, [piece], condition="ground_truth", frame_rate=None)

    assert stored.read_bytes() == before


def test_speech_whose_name_cannot_name_segments_is_told(
    folder: StudyFolder, take: MakeTake
) -> None:
    with pytest.raises(InputError, match=r"my take\.wav: 'my take' is not a usable segment name"):
        import_take(folder, take(name="my take"))


def test_the_face_beside_a_recording_comes_with_it(folder: StudyFolder, take: MakeTake) -> None:
    recording = take()
    assert recording.motion is not None
    weights = np.linspace(0, 1, 300)[:, None] * np.ones(51)
    write_arkit_json(recording.motion.with_suffix(".json"), weights, 60)
    segments, notes = import_take(folder, recording)
    assert "motion.npz: the face is that of motion.json" in notes
    faces = [read_clip(folder.clip("ground_truth", s.name)).arkit for s in segments]
    first, last = faces[0], faces[2]
    assert first is not None
    assert last is not None
    np.testing.assert_allclose(first[:60, 0], np.linspace(0, 1, 300)[:120:2], atol=1e-3)
    # The face lasts five of the six seconds, and its last frame is held.
    np.testing.assert_allclose(last[-30:, :51], 1, atol=5e-3)
    np.testing.assert_array_equal(last[:, 51], 0)


def test_another_json_beside_a_recording_is_left_out_and_said(
    folder: StudyFolder, take: MakeTake
) -> None:
    recording = take()
    assert recording.motion is not None
    recording.motion.with_suffix(".json").write_text('{"take": 3}')
    segments, notes = import_take(folder, recording)
    assert any("motion.json lies beside motion.npz and is left out" in note for note in notes)
    assert read_clip(folder.clip("ground_truth", segments[0].name)).arkit is None
