from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from analysis.evaluators.clip_views import Channels
from analysis.evaluators.evaluator import load_evaluator
from analysis.evaluators.networks import AutoencoderConfig, AutoencoderNetwork
from analysis.evaluators.training import PRESETS, ClipSource, EvaluatorRequest, train_evaluator
from motion.clip import MotionClip
from motion.errors import InputError
from motion.resample import resample
from tests.analysis.evaluators.conftest import trained
from tests.analysis.evaluators.swinging import source, sources, swinging


def request(
    kind: str = "motion", channels: Channels = "gesture", **options: Any
) -> EvaluatorRequest:
    preset = PRESETS[kind]["tiny"]
    return EvaluatorRequest(channels=channels, preset=preset, changes={"steps": 1}, **options)


def test_training_is_reproducible_and_excludes_held_out_recordings(
    gesture_file: Path, tmp_path: Path
) -> None:
    again = trained(tmp_path, "motion", "gesture", steps=4)
    assert again.read_bytes() == gesture_file.read_bytes()
    facts = load_evaluator(gesture_file).facts
    assert facts.data["held_out"] == "2 of 10 recordings"
    assert (facts.data["windows"], facts.data["held_out_windows"]) == (8 * 9, 2 * 9)


def test_clips_that_cannot_be_used_or_have_another_kind_of_face_are_left_out(
    tmp_path: Path,
) -> None:
    def damaged() -> MotionClip:
        raise InputError("the file is cut off", where="c.npz", remedy="Record it again")

    clip = swinging("anger", 52)
    expressive = replace(clip, arkit=None, expressions=np.zeros((len(clip), 100), np.float32))
    given = (
        *sources(),
        replace(source("anger", 50), name="c", read=damaged),
        source("anger", 51, seconds=1.0),
        replace(source("anger", 52), name="zz", read=lambda: expressive),
    )
    asked = request(channels="expression")
    facts, skipped = train_evaluator(asked, given, tmp_path / "m.safetensors")
    assert [error.where for error in skipped] == ["anger-51", "c.npz", "zz"]
    assert "lasts 1.00 s" in skipped[0].what
    assert (facts.data["clips"], facts.face) == (10, "arkit")


@pytest.mark.parametrize(
    ("asked", "given", "said"),
    [
        (
            request(),
            (source("anger", 0, seconds=1),),
            "0 windows of 2.267 s to learn from.*1 could not be used, the first: anger-0: .*lasts",
        ),
        (request(), (source("anger", 0), source("anger", 1)), "9 windows of 2.267 s to learn from"),
        (request("emotion", "body"), sources(1)[:1], "all usable clips show one emotion, 'anger'"),
        (
            request("emotion", "body"),
            (replace(source("anger", 0), emotion=""),),
            "its emotion is not stated",
        ),
        (request(channels="both", frozen=("face",)), sources(1), "face is held still"),
    ],
)
def test_too_little_to_learn_from_is_refused_with_a_remedy(
    asked: EvaluatorRequest, given: tuple[ClipSource, ...], said: str, tmp_path: Path
) -> None:
    out = tmp_path / "m.safetensors"
    with pytest.raises(InputError, match=said) as refused:
        train_evaluator(asked, given, out)
    assert refused.value.remedy
    assert not out.exists()


def test_a_run_is_not_resumed_with_other_recordings(tmp_path: Path) -> None:
    out = tmp_path / "m.safetensors"
    train_evaluator(request(), sources(), out)
    before = out.read_bytes()
    read_otherwise = replace(sources()[0], read=lambda: swinging("anger", 0, frame_rate=24))
    for other in (source("anger", 60), read_otherwise):
        with pytest.raises(InputError, match="data sha256 was"):
            train_evaluator(request(), (*sources()[1:], other), out)
    assert out.read_bytes() == before


@pytest.mark.parametrize(("recordings", "how"), [(5, "1 of 5 recordings"), (1, "2 of 10 clips")])
def test_frames_are_normalised_without_the_recordings_or_clips_held_out(
    recordings: int, how: str, tmp_path: Path
) -> None:
    given = [
        replace(one, recording=f"r{number % recordings}") for number, one in enumerate(sources())
    ]
    facts, _ = train_evaluator(request(), given, tmp_path / "m.safetensors")
    assert facts.data["held_out"] == how
    frames = [facts.view().frames(resample(one.read(), 15)) for one in given]
    mean = load_evaluator(tmp_path / "m.safetensors").normalisation.mean
    (held_out,) = (
        pair
        for pair in combinations(range(10), 2)
        if np.allclose(np.delete(frames, pair, axis=0).mean(axis=(0, 1)), mean, atol=1e-6)
    )
    assert recordings == 1 or len({given[number].recording for number in held_out}) == 1


TINY = AutoencoderConfig(frame_rate=15.0, window=12, stride=10, features=4)


@pytest.mark.parametrize("window", [12, 13, 34, 60])
def test_windows_of_any_length_are_reconstructed_in_their_shape(window: int) -> None:
    network = AutoencoderNetwork(replace(TINY, window=window), 7)
    windows = torch.randn(3, window, 7)
    assert network.embed(windows).shape == (3, 4)
    assert network(windows).shape == windows.shape


def test_unseen_windows_are_reconstructed_better_than_by_the_mean() -> None:
    torch.manual_seed(0)
    network = AutoencoderNetwork(replace(TINY, features=8), 4)
    phases, sizes = 6 * torch.rand(600, 1, 1), 0.5 + 1.5 * torch.rand(600, 1, 1)
    windows = sizes * torch.sin(0.5 * torch.arange(12)[:, None] + phases + torch.arange(4))
    optimizer = torch.optim.Adam(network.parameters(), lr=0.01)
    for _ in range(150):
        batch = windows[torch.randint(500, (32,))]
        optimizer.zero_grad()
        network.losses(batch, batch)["loss"].backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    with torch.no_grad():
        measured = network.eval().losses(windows[500:], windows[500:])
    assert measured["error"] < 0.5 * measured["error_of_mean"]
