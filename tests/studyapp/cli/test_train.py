"""`motionjury train`: networks for metrics, and for `motionjury generate`."""

import shutil
from pathlib import Path

import pytest

from analysis.evaluators.evaluator import load_evaluator
from motion.formats import read_clip, write_clip
from tests.analysis.evaluators.swinging import SWINGS, swinging
from tests.support.command_line import run
from tests.support.short_training import short_training
from training.device import torch_threads


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return ten clips of two emotions, and one that is damaged."""
    folder = tmp_path_factory.mktemp("recorded")
    rows = ["name,emotion"]
    for emotion in SWINGS:
        for seed in range(5):
            write_clip(folder / f"{emotion}{seed}.npz", swinging(emotion, seed))
            rows.append(f"{emotion}{seed},{emotion}")
    (folder / "cut.npz").write_bytes(b"cut")
    (folder / "segments.csv").write_text("\n".join([*rows, "cut,anger"]))
    return folder


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return sixteen takes by two speakers."""
    if shutil.which("espeak-ng") is None:
        pytest.skip("espeak-ng is not installed")
    folder = tmp_path_factory.mktemp("corpus") / "corpus"
    size = ("--speakers", 2, "--sentences", 8, "--takes", 1, "--held-out-speakers", 0)
    made = run("corpus", folder, *size, "--fps", 15, "--processes", 1)
    assert "Made 16 takes" in made
    return folder


@torch_threads(1)
def test_a_network_is_trained_and_damaged_files_are_counted(recorded: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "m.safetensors"
    given = ("emotion", "--data", recorded, "--config", "tiny", "--steps", 12, "--out", out)
    shown = run("train", "evaluator", *given)
    assert f"skipped: {recorded / 'cut.npz'}" in shown
    assert "1 clip skipped." in shown
    assert "Learned from 40 windows of 10 clips; held out 2 of 10 recordings" in shown
    assert "Accuracy on held-out data with 2 emotions: 1.000" in shown
    assert f"Wrote {out}" in shown
    assert load_evaluator(out).labels == ("anger", "sadness")
    assert (tmp_path / "new" / "m.run" / "curves.png").stat().st_size > 1000


@short_training()
def test_a_network_that_learned_nothing_is_reported(recorded: Path, tmp_path: Path) -> None:
    given = ("motion", "--data", recorded, "--config", "tiny", "--steps", 1, "--seed", 3)
    shown = run("train", "evaluator", *given, "--out", tmp_path / "m.safetensors")
    assert "The network is no better than that baseline" in shown


@pytest.mark.slow
@short_training()
def test_a_network_trained_on_a_corpus_moves_like_its_speakers(
    corpus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("generators.diffsheg.train.VALIDATION_WINDOWS", 128)
    recordings, out = tmp_path / "recordings", tmp_path / "networks" / "two.safetensors"
    shutil.copytree(corpus, recordings)
    damaged = sorted(recordings.glob("1/*.bvh"))[0]
    damaged.write_bytes(damaged.read_bytes()[:2000])
    options = ("--data", recordings, "--config", "tiny", "--batch-size", 8, "--out", out)
    given = ("train", "diffsheg", *options)

    trained = run(*given, "--steps", 3)
    assert f"skipped: {damaged}" in trained
    assert "1 take skipped." in trained
    assert "by 2 speakers" in trained
    assert f"Wrote {out}." in trained
    more = run(*given, "--steps", 4)
    assert "noise and reconstruction" in more

    speech = sorted(recordings.glob("2/*.wav"))[0]
    speaker = speech.stem.split("_")[1]
    run(
        *("generate", "--generator", "diffsheg", "--checkpoint", out, "--speaker", speaker),
        *("--speech", speech, "--out", tmp_path / "clips"),
    )
    clip = read_clip(tmp_path / "clips" / f"{speech.stem}.npz")
    assert clip.provenance["speaker"] == speaker
    assert clip.provenance["dataset"] == "beat"
    assert clip.arkit is not None
    assert clip.arkit.max() > 0
