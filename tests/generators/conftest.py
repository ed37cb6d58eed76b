"""Speech of known rhythm, and a small study of clips."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from generators.interface import Generator, SpeechSegment
from generators.learned_settings import DiffShegSettings, S2ueSettings
from generators.registry import load_generator
from generators.rule_based.generator import RuleBased
from motion.audio import Audio
from motion.clip import MotionClip
from motion.segment import EMOTIONS, Segment
from tests.generators.amuse.small_networks import written_networks
from tests.generators.diffsheg.small_network import written_network
from tests.generators.s2ue.small_network import written_network as small_s2ue
from tests.support.short_training import trained_shortly

__all__ = ["trained_shortly"]

RATE = 16000


def syllables(seconds: float, seed: int) -> Audio:
    """Humps of a buzzing voice, some louder and higher, and a pause in the middle."""
    rng = np.random.default_rng(seed)
    times = np.arange(round(seconds * RATE)) / RATE
    gaps = rng.uniform(0.22, 0.5, int(seconds / 0.3))
    peaks = 0.4 + np.cumsum(gaps)
    peaks = peaks[(peaks < seconds - 0.2) & (np.abs(peaks - seconds / 2) > 0.3)]
    envelope, pitch = np.zeros_like(times), np.full_like(times, 120.0)
    for peak in peaks:
        hump = np.cos(np.clip((times - peak) / 0.2, -0.5, 0.5) * np.pi) ** 2
        stress = rng.choice([0.3, 1.0])
        envelope = np.maximum(envelope, stress * hump)
        pitch = pitch + 25 * stress * hump
    phase = 2 * np.pi * np.cumsum(pitch) / RATE
    voice = sum(np.sin(k * phase) / k for k in range(1, 20))
    return Audio((0.2 * envelope * voice).astype(np.float32), RATE)


def as_speech(audio: Audio, name: str = "a", **facts: str) -> SpeechSegment:
    facts = {"speaker": "synthetic", "emotion": "neutral"} | facts
    segment = Segment(name=name, wav=f"{name}.wav", start=0.0, end=audio.duration, **facts)
    return SpeechSegment(segment=segment, audio=audio)


def spoken(name: str, seconds: float, seed: int = 0, **facts: str) -> SpeechSegment:
    return as_speech(syllables(seconds, seed), name, **facts)


@dataclass(frozen=True)
class ClipsInMemory:
    """The clips of a condition, kept in memory."""

    segments: list[Segment]
    clips: dict[str, MotionClip]

    def clip(self, segment_name: str) -> MotionClip:
        return self.clips[segment_name]


@pytest.fixture(scope="session")
def study() -> ClipsInMemory:
    """Three segments of different length whose clips run at 25 fps."""
    clips = ClipsInMemory([], {})
    for number in range(3):
        speech = spoken(f"segment-{number}", 4.0 + number, number, emotion=EMOTIONS[number])
        clips.segments.append(speech.segment)
        clips.clips[speech.segment.name] = RuleBased().generate(speech, seed=number, frame_rate=25)
    return clips


@pytest.fixture(scope="session")
def load(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Generator]:
    """Return how to load any generator; a learned one is a small network of random weights."""
    folder = tmp_path_factory.mktemp("models")
    settings = {
        "diffsheg": DiffShegSettings(checkpoint=written_network(folder / "small.safetensors")),
        "amuse": written_networks(folder),
        "s2ue": S2ueSettings(checkpoint=small_s2ue(folder / "s2ue.safetensors")),
    }
    return lambda name: load_generator(name, settings.get(name))
