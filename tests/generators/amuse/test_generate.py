"""AMUSE as a generator."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.seams import windows_of
from generators.amuse.generate import Amuse
from generators.amuse.model import MotionModel
from generators.amuse.network_file import (
    MotionNetworks,
    SpeechNetwork,
    load_motion,
    write_motion,
    write_speech,
)
from generators.amuse.speech import SpeechAutoencoder
from generators.interface import SpeechSegment
from generators.learned_settings import AmuseSettings
from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.errors import InputError
from tests.generators.amuse.small_networks import MOTION, SPEECH, written_networks
from tests.generators.conftest import as_speech
from tests.support.sounds import tone


@pytest.fixture(name="settings", scope="module")
def _settings(tmp_path_factory: pytest.TempPathFactory) -> AmuseSettings:
    return written_networks(tmp_path_factory.mktemp("amuse"))


def _speech(seconds: float, hertz: float = 180.0) -> SpeechSegment:
    return as_speech(tone(seconds, hertz), "hello", speaker="anna")


def _clip(settings: AmuseSettings, speech: SpeechSegment, seed: int = 1) -> MotionClip:
    return Amuse(settings, "cpu").generate(speech, seed=seed, frame_rate=30)


def _recording(folder: Path, hertz: float) -> Path:
    path = folder / f"{hertz:g}.wav"
    write_wav(path, tone(4.0, hertz))
    return path


def test_windows_of_long_speech_with_a_long_pause_are_recorded(settings: AmuseSettings) -> None:
    heard: list[tuple[int, int]] = []
    samples = tone(30.0, 180).samples.copy()
    samples[9 * 16_000 : 21 * 16_000] = 0
    speech = as_speech(Audio(samples, 16_000), speaker="anna")
    clip = Amuse(settings, "cpu").generate(
        speech, seed=1, frame_rate=30, on_part=lambda *part: heard.append(part)
    )
    windows = windows_of(clip)
    assert heard == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert windows.step * 3 + 300 >= len(clip) == 900
    assert windows.overlap == 30


def test_parts_of_two_speeches_are_combined_as_named(
    settings: AmuseSettings, tmp_path: Path
) -> None:
    first, second = _recording(tmp_path, 180), _recording(tmp_path, 520)
    swapped = settings.model_copy(update={"emotion": second, "style": second})
    from_second = settings.model_copy(update={"content": first})
    one, other = _speech(4.0, 180), _speech(4.0, 520)
    clips = [_clip(settings, one), _clip(swapped, one), _clip(from_second, other)]
    plain, result, expected = (clip.poses for clip in clips)
    assert np.abs(result - expected).max() < 1e-3
    assert not np.allclose(result, plain, atol=1e-4)
    assert clips[1].provenance["emotion"] == clips[1].provenance["style"] == "520.wav"


@pytest.mark.parametrize(
    ("begin", "end", "left"),
    [
        ({}, {"emotion": "fear"}, {}),
        ({"emotion": "happiness"}, {"emotion": "fear"}, {"from_emotion": "happiness"}),
        ({"style": "anna"}, {"style": "520.wav"}, {"from_style": "anna"}),
    ],
)
def test_motion_is_interpolated_between_named_labels_or_the_speechs_own(
    settings: AmuseSettings,
    begin: dict[str, str],
    end: dict[str, str],
    left: dict[str, str],
    tmp_path: Path,
) -> None:
    _recording(tmp_path, 520)

    def moved(**changes: object) -> MotionClip:
        return _clip(settings.model_copy(update=changes).resolved_in(tmp_path), _speech(3.0))

    first, last = (moved(**named).poses for named in (begin, end))
    clips = [moved(**end, **left, strength=share) for share in (0.0, 0.5, 1.0)]
    none, half, full = (clip.poses for clip in clips)
    assert np.abs(first - none).max() < 1e-5
    assert np.abs(last - full).max() < 1e-5
    assert 0 < np.linalg.norm(half - first) < np.linalg.norm(full - first)
    assert clips[1].provenance.items() >= left.items()


@pytest.mark.parametrize(
    ("changes", "seconds", "message"),
    [
        ({"emotion": "disgust"}, 3.0, r"no emotion 'disgust': it learned fear and happiness"),
        ({"style": "berta"}, 3.0, r"no style 'berta': it learned anna"),
        ({"from_emotion": "disgust", "emotion": "fear"}, 3.0, r"no emotion 'disgust'"),
        ({"emotion": "still.wav"}, 3.0, r"still\.wav: the recording is silent"),
        ({"emotion": "missing.wav"}, 3.0, "no such recording of emotion"),
        ({}, 0.2, r"^segment \w+: the recording lasts 0\.20 s, too short"),
    ],
)
def test_unusable_speech_and_unknown_labels_are_refused(
    settings: AmuseSettings, changes: dict[str, str], seconds: float, message: str, tmp_path: Path
) -> None:
    write_wav(tmp_path / "still.wav", Audio(np.zeros(32_000, np.float32), 16_000))
    with pytest.raises(InputError, match=message):
        _clip(settings.model_copy(update=changes).resolved_in(tmp_path), _speech(seconds))


def test_a_speech_model_other_than_in_training_is_refused(
    settings: AmuseSettings, tmp_path: Path
) -> None:
    networks = load_motion(settings.checkpoint)
    learned = replace(networks, training={"speech_model": "0" * 64})
    write_motion(tmp_path / "motion.safetensors", learned)
    changed = settings.model_copy(update={"checkpoint": tmp_path / "motion.safetensors"})
    with pytest.raises(InputError, match="trained with another speech model"):
        _clip(changed, _speech(3.0))


def test_speech_without_disentanglement_drives_frames_as_a_whole(tmp_path: Path) -> None:
    whole = written_networks(tmp_path)
    speech = SpeechAutoencoder(replace(SPEECH, mfcc=4))
    motion = MotionModel(replace(MOTION, conditions=1, prior=False, frames=60))
    write_speech(whole.speech_model, SpeechNetwork(model=speech))
    write_motion(whole.checkpoint, MotionNetworks(model=motion))
    low, high = (_clip(whole, _speech(2.0, hertz)) for hertz in (200, 2000))
    assert len(low) == 60
    assert (low.poses != high.poses).any()
    with pytest.raises(InputError, match=r"does not disentangle speech, so emotion .*Leave out"):
        _clip(whole.model_copy(update={"emotion": "happiness"}), _speech(2.0))
