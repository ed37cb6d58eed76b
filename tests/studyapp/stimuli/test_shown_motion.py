from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from motion.clip import MotionClip
from motion.segment import Segment
from renderer.look import FIRST_AVATAR
from studyapp.stimuli.shown_motion import (
    body_file,
    expression_matrix_file,
    left_out,
    segment_scene,
    shown_abilities,
    shown_body,
)
from studyapp.study.folder import StudyFolder
from tests.support.studies.edited_study import edited
from tests.support.studies.takes import write_motion, write_speech


def _clip(**face: Any) -> MotionClip:
    still = np.zeros((2, 55, 3), np.float32)
    return MotionClip(poses=still, trans=still[:, 0], frame_rate=30, **face)


def _set_video(folder: StudyFolder, **values: str) -> None:
    with edited(folder.definition) as document:
        document["video"].update(values)


def _name_matrix(folder: StudyFolder, shape: tuple[int, int]) -> None:
    np.save(folder.root / "face.npy", np.ones(shape))
    _set_video(folder, expression_matrix="face.npy")


def test_paths_of_the_study_file_begin_at_its_folder(folder: StudyFolder, tmp_path: Path) -> None:
    _set_video(folder, body="models/SMPLX_NEUTRAL.npz")
    _set_video(folder, expression_matrix=str(tmp_path / "face.csv"))
    study = folder.study()
    assert body_file(folder, study) == folder.root / "models/SMPLX_NEUTRAL.npz"
    assert expression_matrix_file(folder, study) == tmp_path / "face.csv"


def test_abilities_are_those_of_the_body_that_is_built(folder: StudyFolder) -> None:
    _name_matrix(folder, (100, 52))
    study = folder.study()
    assert study.video.avatar == FIRST_AVATAR
    assert shown_abilities(folder, study) == shown_body(folder, study).abilities


def test_the_mannequin_has_no_face(folder: StudyFolder) -> None:
    _set_video(folder, avatar="mannequin")
    assert not shown_abilities(folder, folder.study()).has_face


def test_each_condition_is_named_once(folder: StudyFolder) -> None:
    coefficients = _clip(expressions=np.ones((2, 100)))
    shown = [("one", coefficients), ("two", _clip()), ("one", coefficients)]
    (sentence,) = left_out(shown, shown_abilities(folder, folder.study()))
    assert sentence.startswith("one: ")
    _name_matrix(folder, (52, 100))
    assert left_out(shown, shown_abilities(folder, folder.study())) == ()


def test_another_segments_speech_is_heard_no_longer_than_the_motion(folder: StudyFolder) -> None:
    folder.speech.mkdir()
    write_speech(folder.speech / "take.wav", 5.0)
    short, long, gone = (
        Segment(name=name, wav=wav, start=start, end=end, speaker="robin", emotion="neutral")
        for name, wav, start, end in (
            ("short", "take.wav", 0.0, 2.0),
            ("long", "take.wav", 2.0, 5.0),
            ("gone", "gone.wav", 0.0, 2.0),
        )
    )
    write_motion(folder.clip("ours", "short"), 2.0)

    def speech_seconds(speech: Segment | None) -> float | None:
        scene, missing = segment_scene(folder, folder.study(), short, ["ours"], speech=speech)
        assert (list(scene.clips), missing) == (["ours"], {})
        return None if scene.speech is None else round(scene.speech.duration, 3)

    assert [speech_seconds(speech) for speech in (short, long, gone, None)] == [2, 2, None, None]
