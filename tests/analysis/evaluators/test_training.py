from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from analysis.evaluators.clip_views import Channels
from analysis.evaluators.design import TRAINING, EvaluatorRequest, Kind
from analysis.evaluators.evaluator import load_evaluator
from analysis.evaluators.examples import Split, split
from analysis.evaluators.networks import AutoencoderConfig, AutoencoderNetwork
from analysis.evaluators.training import train_evaluator
from analysis.evaluators.training_clips import ClipSource
from motion.arrays import Floats32, Ints
from motion.clip import MotionClip
from motion.errors import InputError
from tests.analysis.evaluators.conftest import trained
from tests.analysis.evaluators.swinging import source, sources, swinging
from training.run.records import RunFolder


def request(
    kind: Kind = "motion", channels: Channels = "gesture", **options: Any
) -> EvaluatorRequest:
    training = replace(TRAINING[kind, "tiny"], steps=1)
    return EvaluatorRequest(kind=kind, size="tiny", channels=channels, training=training, **options)


def test_training_is_reproducible_and_excludes_held_out_recordings(
    gesture_file: Path, tmp_path: Path
) -> None:
    again = trained(tmp_path, "motion", "gesture", steps=4)
    assert again.read_bytes() == gesture_file.read_bytes()
    facts = load_evaluator(gesture_file).facts
    assert facts.data.held_out == "2 of 10 recordings"
    assert (facts.data.windows, facts.data.held_out_windows) == (8 * 9, 2 * 9)


def test_clips_that_cannot_be_used_are_named_and_left_out(tmp_path: Path) -> None:
    def damaged() -> MotionClip:
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


def test_clips_with_another_kind_of_face_than_the_first_are_left_out(tmp_path: Path) -> None:
    clip = swinging("anger", 52)
    expressive = replace(clip, arkit=None, expressions=np.zeros((len(clip), 100), np.float32))
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
            r"the usable clips \(1\) show one emotion, 'anger'",
        ),
        (
            request("emotion", "body"),
            (replace(source("anger", 0), emotion=""),),
            "its emotion is not stated",
        ),
    ],
)
def test_too_little_to_learn_from_is_refused_with_a_remedy(
    asked: EvaluatorRequest, given: tuple[ClipSource, ...], said: str, tmp_path: Path
) -> None:
    out = tmp_path / "m.safetensors"
    with pytest.raises(InputError, match=said) as refused:
        train_evaluator(asked, given, out, RunFolder(tmp_path / "run"))
    assert refused.value.remedy
    assert not out.exists()


def test_a_frozen_face_cannot_be_learned() -> None:
    with pytest.raises(InputError, match="face is held still"):
        request(channels="both", frozen=("face",))


def test_a_run_is_not_resumed_with_other_recordings(tmp_path: Path) -> None:
    out, folder = tmp_path / "m.safetensors", RunFolder(tmp_path / "run")
    train_evaluator(request(), sources(), out, folder)
    before = out.read_bytes()
    read_otherwise = replace(sources()[0], read=lambda: swinging("anger", 0, frame_rate=24))
    for other in (source("anger", 60), read_otherwise):
        with pytest.raises(InputError, match="data sha256 was"):
            train_evaluator(request(), (*sources()[1:], other), out, folder)
    assert out.read_bytes() == before


def parts(recordings: list[str], labels: list[str], frames: int = 50) -> Split:
    """Return the split of clips whose frames count on, so that a frame tells its place."""
    clips = [
        np.arange(number * 1000, number * 1000 + frames, dtype=np.float32)[:, None]
        for number in range(len(recordings))
    ]
    return split(
        clips,
        recordings,
        labels,
        names=sorted(set(labels)),
        window=10,
        stride=5,
        floor=np.full(1, 0.01, np.float32),
        seed=0,
        device="cpu",
    )


def places(found: Split, rows: Ints, *, held_out: bool = False) -> Floats32:
    """Return the frames of windows as they were counted."""
    examples = found.held_out if held_out else found.training
    windows, _ = examples.batch(rows)
    norm = found.normalisation
    return np.asarray(np.rint(windows[:, :, 0].numpy() * norm.deviation + norm.mean))


def test_windows_stay_within_clips_and_training_excludes_held_out_recordings() -> None:
    found = parts([f"r{n // 2}" for n in range(20)], ["x"] * 20)
    learned = places(found, np.arange(len(found.training)))
    kept_back = places(found, np.arange(len(found.held_out)), held_out=True)
    for counted in (learned, kept_back):
        np.testing.assert_array_equal(np.diff(counted, axis=1), 1)
    assert set(learned[:, 0] // 2000).isdisjoint(kept_back[:, 0] // 2000)
    assert (len(learned), len(kept_back)) == (16 * 9, 4 * 9)
    assert (found.recordings, found.how) == (10, "2 of 10 recordings")


def test_one_recording_is_split_in_time_and_normalised_without_its_held_out_part() -> None:
    found = parts(["r"], ["x"], frames=100)
    learned = places(found, np.arange(len(found.training)))
    kept_back = places(found, np.arange(len(found.held_out)), held_out=True)
    assert learned.max() < 80 <= kept_back.min()
    assert found.how == "the last fifth of every clip, since there is one recording"
    np.testing.assert_allclose(found.normalisation.mean, np.arange(80).mean())
    np.testing.assert_allclose(found.normalisation.deviation, np.arange(80).std(), rtol=1e-5)


@pytest.mark.parametrize("window", [12, 13, 34, 60])
def test_windows_of_any_length_are_reconstructed_in_their_shape(window: int) -> None:
    network = AutoencoderNetwork(AutoencoderConfig(window=window, features=4), 7)
    windows = torch.randn(3, window, 7)
    assert network.embed(windows).shape == (3, 4)
    assert network(windows).shape == windows.shape


def test_the_autoencoder_loss_covers_values_and_their_differences() -> None:
    network = AutoencoderNetwork(AutoencoderConfig(window=12, features=4), 7).eval()
    windows = torch.randn(3, 12, 7)
    losses = network.losses(windows, torch.zeros(3))
    off = network(windows) - windows
    torch.testing.assert_close(losses["error"], off.abs().mean())
    torch.testing.assert_close(losses["change"], (off[:, 1:] - off[:, :-1]).abs().mean())
    torch.testing.assert_close(losses["loss"], losses["error"] + losses["change"])


def test_unseen_windows_are_reconstructed_better_than_by_the_mean() -> None:
    torch.manual_seed(0)
    network = AutoencoderNetwork(AutoencoderConfig(window=12, features=8), 4)
    phases, sizes = 6 * torch.rand(600, 1, 1), 0.5 + 1.5 * torch.rand(600, 1, 1)
    windows = sizes * torch.sin(0.5 * torch.arange(12)[:, None] + phases + torch.arange(4))
    optimizer = torch.optim.Adam(network.parameters(), lr=0.01)
    for _ in range(150):
        batch = windows[torch.randint(500, (32,))]
        optimizer.zero_grad()
        network.losses(batch, batch)["loss"].backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    with torch.no_grad():
        measured = network.eval().measured(windows[500:], windows[500:])
    assert measured["error"] < 0.5 * measured["error_of_mean"]
