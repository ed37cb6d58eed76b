from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analysis.evaluators.design import TRAINING, EvaluatorRequest
from analysis.evaluators.evaluator import load_evaluator
from analysis.evaluators.training import train_evaluator
from motion.errors import InputError
from tests.analysis.evaluators.conftest import trained
from tests.analysis.evaluators.swinging import source, sources, swinging
from training.run.folder import RunFolder


def request(kind: str = "motion", channels: str = "gesture", **options: object) -> EvaluatorRequest:
    training = replace(TRAINING[kind, "tiny"], steps=1)
    return EvaluatorRequest(kind=kind, size="tiny", channels=channels, training=training, **options)


def test_two_trainings_write_the_same_bytes(gesture_file: Path, tmp_path: Path) -> None:
    again = trained(tmp_path, "motion", "gesture", steps=4)
    assert again.read_bytes() == gesture_file.read_bytes()


def test_recordings_are_kept_back_whole(gesture_file: Path) -> None:
    facts = load_evaluator(gesture_file).file.facts
    assert facts.data.held_out == "2 of 10 recordings"
    assert facts.data.windows == 8 * 9
    assert facts.data.held_out_windows == 2 * 9


def test_clips_that_cannot_be_used_are_named_and_left_out(tmp_path: Path) -> None:
    def damaged() -> None:
        raise InputError("the file is cut off", where="c.npz", remedy="Record it again")

    given = (
        *sources(),
        replace(source("anger", 50), name="c", read=damaged),
        source("anger", 51, seconds=1.0),
    )
    found = train_evaluator(request(), given, tmp_path / "m.safetensors", RunFolder(tmp_path))
    assert [error.where for error in found.skipped] == ["anger-51", "c.npz"]
    assert "lasts 1.00 s" in found.skipped[0].what
    assert found.facts.data.clips == 10


def test_the_face_of_the_first_clip_decides_and_others_are_left_out(tmp_path: Path) -> None:
    clip = swinging("anger", 52)
    expressive = replace(clip, arkit=None, expressions=np.zeros((len(clip), 100)))
    given = (*sources(), replace(source("anger", 52), name="zz", read=lambda: expressive))
    found = train_evaluator(
        request(channels="expression"), given, tmp_path / "m.safetensors", RunFolder(tmp_path)
    )
    assert found.facts.face == "arkit"
    assert [error.where for error in found.skipped] == ["zz"]


@pytest.mark.parametrize(
    ("asked", "given", "said"),
    [
        (
            request(),
            (source("anger", 0, seconds=1),),
            r"no clip to learn from; 1 could not be used \(anger-0: the clip lasts",
        ),
        (request(), (), "no clip to learn from"),
        (request(), (source("anger", 0), source("anger", 1)), "9 windows of 2.267 s to learn from"),
        (
            request("emotion", "body"),
            sources(1)[:1],
            "the clips that can be used, 1, show one emotion, 'anger'",
        ),
        (
            request("emotion", "body"),
            (replace(source("anger", 0), emotion=""),),
            "nothing says which emotion",
        ),
    ],
)
def test_too_little_to_learn_from_is_refused_with_a_remedy(
    asked: EvaluatorRequest, given: tuple, said: str, tmp_path: Path
) -> None:
    out = tmp_path / "m.safetensors"
    with pytest.raises(InputError, match=said) as refused:
        train_evaluator(asked, given, out, RunFolder(tmp_path / "run"))
    assert refused.value.remedy
    assert not out.exists()


def test_a_face_that_is_held_still_cannot_be_learned() -> None:
    with pytest.raises(InputError, match="face is held still"):
        request(channels="both", frozen=("face",))


def test_other_recordings_do_not_continue_a_run(tmp_path: Path) -> None:
    out, folder = tmp_path / "m.safetensors", RunFolder(tmp_path / "run")
    train_evaluator(request(), sources(), out, folder)
    before = out.read_bytes()
    read_otherwise = replace(sources()[0], read=lambda: swinging("anger", 0, frame_rate=24))
    for other in (source("anger", 60), read_otherwise):
        with pytest.raises(InputError, match="data sha256 was"):
            train_evaluator(request(), (*sources()[1:], other), out, folder)
    assert out.read_bytes() == before
