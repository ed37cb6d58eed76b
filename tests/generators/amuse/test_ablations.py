"""AMUSE without its prior, and without its speech model (Table A.3)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from generators.amuse.generate import Amuse
from generators.amuse.model import MotionModel
from generators.amuse.network_file import (
    MotionNetworks,
    SpeechNetwork,
    write_motion_networks,
    write_speech_network,
)
from generators.amuse.settings import AmuseSettings
from generators.amuse.speech import SpeechAutoencoder
from generators.interface import SpeechSegment
from motion.audio import Audio
from motion.errors import InputError
from motion.segment import Segment
from tests.generators.amuse.small_networks import MOTION, SPEECH, written_networks


def _speech(hertz: float) -> SpeechSegment:
    times = np.arange(32_000) / 16_000
    samples = (0.3 * np.sin(2 * np.pi * hertz * times)).astype(np.float32)
    segment = Segment(name="a", wav="a.wav", start=0.0, end=2.0, speaker="anna", emotion="neutral")
    return SpeechSegment(segment=segment, audio=Audio(samples, 16_000))


def test_without_a_prior_the_denoiser_tells_the_frames_themselves(tmp_path: Path) -> None:
    config = replace(MOTION, frames=60, prior=False)
    model = MotionModel(config)
    noise = torch.randn(2, 60, 333)
    told = [torch.randn(2, 1, 8) for _ in range(3)]
    assert model.denoiser(noise, torch.tensor([3]), *told).shape == noise.shape
    settings = written_networks(tmp_path)
    write_motion_networks(settings.checkpoint, MotionNetworks(model=model))
    clips = [
        Amuse(settings, "cpu").generate(_speech(hertz), seed=1, frame_rate=30)
        for hertz in (200, 200, 2000)
    ]
    assert len(clips[0]) == 60
    assert (clips[0].poses == clips[1].poses).all()
    assert (clips[0].poses != clips[2].poses).any()


@pytest.fixture(name="whole")
def _whole(tmp_path: Path) -> AmuseSettings:
    """Networks of which the denoiser is told one latent of all that is heard."""
    settings = written_networks(tmp_path)
    config = replace(SPEECH, mfcc=4)
    model = SpeechAutoencoder(config)
    motion = MotionModel(replace(MOTION, conditions=1, prior=False, frames=60))
    write_speech_network(settings.speech_model, SpeechNetwork(model=model))
    write_motion_networks(settings.checkpoint, MotionNetworks(model=motion))
    return settings


def test_speech_that_is_not_taken_apart_moves_as_a_whole(whole: AmuseSettings) -> None:
    low, high = (
        Amuse(whole, "cpu").generate(_speech(hertz), seed=1, frame_rate=30) for hertz in (200, 2000)
    )
    assert (low.poses != high.poses).any()


def test_no_part_of_speech_that_is_not_taken_apart_can_be_swapped(whole: AmuseSettings) -> None:
    edited = whole.model_copy(update={"emotion": "happiness"})
    with pytest.raises(InputError, match=r"does not take speech apart, so emotion .*Leave out"):
        Amuse(edited, "cpu").generate(_speech(200), seed=1, frame_rate=30)


def test_a_denoiser_of_another_number_of_latents_is_refused(
    whole: AmuseSettings, tmp_path: Path
) -> None:
    (tmp_path / "other").mkdir()
    other = written_networks(tmp_path / "other")
    mixed = whole.model_copy(update={"checkpoint": other.checkpoint})
    with pytest.raises(InputError, match="trained with another speech model"):
        Amuse(mixed, "cpu").generate(_speech(200), seed=1, frame_rate=30)


def test_the_autoencoder_hears_what_the_discrete_cosine_transform_tells() -> None:
    model = SpeechAutoencoder(replace(SPEECH, mfcc=3))
    rows = torch.ones(1, SPEECH.frames, SPEECH.bands)
    found = model.coefficients(rows).view(SPEECH.frames, 3)
    assert torch.allclose(found[:, 0], torch.full((SPEECH.frames,), 128**0.5), rtol=1e-5)
    assert float(found[:, 1:].abs().max()) < 1e-4
    assert sum(isinstance(one, torch.nn.Linear) for one in model.modules()) == 8
