from pathlib import Path

import librosa
import numpy as np
import pytest

from motion.audio import Audio
from motion.errors import InputError
from motion.segment import EMOTIONS
from motion.synthesis import PROSODY_OF_EMOTION, speak, speak_as
from tests.support.sounds import needs_espeak

SENTENCE = "I walked along the river this morning, and everybody was already there."

NEUTRAL = PROSODY_OF_EMOTION["neutral"]


def pitch(audio: Audio) -> np.ndarray:
    """Return the pitch of the voiced frames in Hz."""
    hertz, voiced, _ = librosa.pyin(audio.samples, fmin=50, fmax=500, sr=audio.sample_rate)
    return np.asarray(hertz[voiced])


@pytest.fixture(scope="module")
def spoken(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Audio]:
    folder = tmp_path_factory.mktemp("speech")
    return {emotion: speak(SENTENCE, emotion, folder / f"{emotion}.wav") for emotion in EMOTIONS}


@needs_espeak
def test_each_emotion_is_audible_and_has_its_own_prosody(spoken: dict[str, Audio]) -> None:
    def loudness(emotion: str) -> float:
        return float(np.sqrt(np.mean(spoken[emotion].samples ** 2)))

    for emotion, audio in spoken.items():
        assert loudness(emotion) > 0.02, emotion
        assert np.abs(audio.samples).max() < 0.999, emotion
    assert spoken["fear"].duration < spoken["neutral"].duration < spoken["sadness"].duration
    assert loudness("anger") > loudness("neutral") > loudness("sadness")
    fear, sadness, surprise = (pitch(spoken[name]) for name in ("fear", "sadness", "surprise"))
    assert np.median(fear) > 1.2 * np.median(sadness)
    spread = [np.std(12 * np.log2(hertz)) for hertz in (surprise, sadness)]
    assert spread[0] > 1.5 * spread[1]


@needs_espeak
def test_same_text_gives_the_same_file(tmp_path: Path) -> None:
    for name in ("a.wav", "b.wav"):
        speak(SENTENCE, "fear", tmp_path / name)
    assert (tmp_path / "a.wav").read_bytes() == (tmp_path / "b.wav").read_bytes()


@needs_espeak
def test_text_is_not_interpreted_as_markup_or_options(tmp_path: Path) -> None:
    plain = speak("one and two", "neutral", tmp_path / "a.wav")
    odd = speak("--help one <break time='9s'/> & two", "neutral", tmp_path / "b.wav")
    assert plain.duration < odd.duration < 9


@needs_espeak
def test_an_unknown_voice_is_refused_without_writing_a_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"voice 'nosuch'.*espeak-ng --voices"):
        speak_as(SENTENCE, NEUTRAL, tmp_path / "a.wav", "nosuch")
    assert not list(tmp_path.iterdir())


def test_a_missing_espeak_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="apt-get install espeak-ng"):
        speak(SENTENCE, "neutral", tmp_path / "a.wav")
    assert not list(tmp_path.iterdir())
