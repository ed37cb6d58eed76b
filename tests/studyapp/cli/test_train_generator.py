"""`motionjury train NAME`: from recordings to a network that `motionjury generate` takes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from generators.registry import find_trainable, trainable_names
from motion.formats import read_clip
from tests.support.command_line import run
from tests.support.short_training import short_training


@pytest.fixture(scope="module", autouse=True)
def _short_training() -> Iterator[None]:
    with short_training():
        yield


def test_every_trainable_generator_is_listed_with_the_feature_networks() -> None:
    shown = run("train", "--help")
    assert "evaluator" in shown
    for name in trainable_names():
        assert find_trainable(name).summary[:40] in shown
        run("train", name, "--help")


@pytest.mark.slow
def test_a_network_trained_on_a_corpus_moves_like_its_speakers(
    corpus: Path, tmp_path: Path
) -> None:
    recordings, out = tmp_path / "recordings", tmp_path / "networks" / "two.safetensors"
    shutil.copytree(corpus, recordings)
    damaged = sorted(recordings.glob("1/*.bvh"))[0]
    damaged.write_bytes(damaged.read_bytes()[:2000])
    given = ("train", "diffsheg", "--data", recordings, "--batch-size", 8, "--out", out)

    trained = run(*given, "--steps", 3)
    assert f"skipped: {damaged}" in trained
    assert "1 take skipped." in trained
    assert "by 2 speakers" in trained
    assert "untrained" in trained
    assert f"Wrote {out}." in trained
    more = run(*given, "--steps", 4)
    assert " of 4, where noise and reconstruction of held-out" in more
    other = run(*given, "--steps", 5, "--ablation", "reverse", status=1)
    assert "the run that was started here is another one" in other

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
    stranger = run(
        *("generate", "--generator", "diffsheg", "--checkpoint", out, "--speaker", "nobody"),
        *("--speech", speech, "--out", tmp_path / "others"),
        status=1,
    )
    assert "knows no speaker 'nobody'" in stranger
