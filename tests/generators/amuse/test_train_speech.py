"""AMUSE's speech model learns to disentangle speech."""

from dataclasses import replace
from pathlib import Path
from typing import Final

import pytest
import torch

from generators.amuse.config import SPEECH_PRESETS
from generators.amuse.network_file import load_speech
from generators.amuse.speech import SpeechEncoder, SpeechModel
from generators.amuse.train_speech import train_amuse_speech
from motion.errors import InputError
from tests.generators.amuse.small_networks import SMALL_SPEECH as SMALL
from tests.generators.amuse.toy_speech import toy_speech
from tests.generators.small_training import Learn, test_training_stays_on_its_device, training_on
from training.corpus.plan import CorpusRequest, claim_folder

__all__ = ["test_training_stays_on_its_device"]

TOY_SPEECH: Final = toy_speech()
TWO_TEXTS_HELD_OUT: Final = toy_speech(held_out=2)


@pytest.fixture(name="learn")
def _learn(monkeypatch: pytest.MonkeyPatch) -> Learn:
    small = replace(
        SPEECH_PRESETS["tiny"], network=replace(SMALL, frames=100, patch_stride=16), seconds=1
    )
    monkeypatch.setattr("generators.amuse.train_speech.SPEECH_PRESETS", {"tiny": small})
    usual = {"batch_size": 2, "learning_rate": 3e-3, "validate_every": 5}
    return training_on(TOY_SPEECH, train_amuse_speech, monkeypatch, **usual)


def test_it_learns_to_disentangle_speech_of_unheard_texts(learn: Learn, tmp_path: Path) -> None:
    out = tmp_path / "speech.safetensors"
    outcome = learn(60, out, TWO_TEXTS_HELD_OUT)
    network = load_speech(out)
    result = network.training["held_out"]
    assert result["emotion accuracy"] == result["emotion F1"] == 1
    assert result["style accuracy"] == result["style F1"] == 1
    assert "by 2 speakers (ann, bob)" in outcome.sentences[0]
    assert "quadruples in 2 emotions" in outcome.sentences[1]
    found = outcome.sentences[2]
    assert "In 16 held-out windows it recognises the emotion of 100% (chance 50%)" in found
    # Emotion and style are the same in both recordings of a pair, so swapping them costs little.
    for name in ("xcon", "xemo", "xsty"):
        assert result[name] == pytest.approx(result["self of fours"], rel=0.3)
    assert "In 4 held-out quadruples it is" in found
    assert set(network.latents["emotion"]) == {"anger", "happiness"}
    assert set(network.latents["style"]) == {"ann", "bob"}
    happy, angry = (network.labelled("emotion", name) for name in ("happiness", "anger"))
    assert float((happy - angry).norm()) > 0.1


@pytest.mark.parametrize(
    ("ablation", "told", "left_out"), [("style_only", "sty", "emo"), ("emotion_only", "emo", "sty")]
)
def test_an_ablation_swaps_only_the_parts_it_disentangles(
    learn: Learn, tmp_path: Path, ablation: str, told: str, left_out: str
) -> None:
    outcome = learn(1, tmp_path / "out.safetensors", TWO_TEXTS_HELD_OUT, ablation=ablation)
    result = load_speech(tmp_path / "out.safetensors").training["held_out"]
    log = (tmp_path / "out.run" / "log.jsonl").read_text().splitlines()
    assert f'"{told}"' in log[0]
    assert f'"{left_out}"' not in log[0]
    assert {"xcon", f"x{told}"} <= result.keys()
    assert f"x{left_out}" not in result
    assert outcome.sentences[2].count("with another's") == 2


def test_the_encoders_start_from_the_weights_of_a_folder(learn: Learn, tmp_path: Path) -> None:
    network = SpeechEncoder(replace(SMALL, frames=100)).transformer
    network.save_pretrained(tmp_path / "ast")
    out = tmp_path / "out.safetensors"
    # A tiny learning rate leaves them almost unchanged.
    learn(1, out, encoder_weights=str(tmp_path / "ast"), changes={"learning_rate": 1e-12})
    learned = load_speech(out)
    assert isinstance(learned.model, SpeechModel)
    for encoder in (learned.model.content, learned.model.emotion, learned.model.style):
        for name, value in network.state_dict().items():
            torch.testing.assert_close(encoder.transformer.state_dict()[name], value)
    assert str(learned.training["encoder_weights"]).startswith("ast (sha256 ")
    assert learned.training["held_out"].keys().isdisjoint({"xcon", "xemo", "xsty"})
    with pytest.raises(InputError, match="no encoders to initialise"):
        learn(1, out, ablation="mfcc", encoder_weights=str(tmp_path / "ast"))


def test_an_autoencoder_can_replace_the_speech_model(learn: Learn, tmp_path: Path) -> None:
    out, missed = tmp_path / "out.safetensors", []
    for steps in (1, 20):
        outcome = learn(steps, out.with_stem(str(steps)), ablation="mfcc")
        missed.append(load_speech(out.with_stem(str(steps))).training["held_out"]["loss"])
    assert missed[1] < 0.9 * missed[0]
    assert "reconstruction error in 8 held-out windows" in outcome.sentences[2]


def test_recordings_without_a_known_speaker_for_validation_are_refused(
    learn: Learn, tmp_path: Path
) -> None:
    strangers = tuple(
        replace(take, speaker="eve") if take.split == "validation" else take
        for take in TOY_SPEECH.takes
    )
    with pytest.raises(InputError, match="no recording for validation has both a speaker"):
        learn(1, tmp_path / "out.safetensors", replace(TOY_SPEECH, takes=strangers))


def test_a_corpus_whose_speakers_share_no_texts_is_refused(learn: Learn, tmp_path: Path) -> None:
    claim_folder(tmp_path / "corpus", CorpusRequest(sentences=32, shared_passages=False))
    takes = [replace(take, speech=tmp_path / "corpus" / take.speech) for take in TOY_SPEECH.takes]
    in_corpus = replace(TOY_SPEECH, takes=tuple(takes))
    with pytest.raises(InputError, match=r"has their own texts.*--shared-passages"):
        learn(1, tmp_path / "out.safetensors", in_corpus)
