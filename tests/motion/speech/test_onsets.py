from __future__ import annotations

import numpy as np
import pytest

from motion.audio import Audio, read_audio
from motion.speech.onsets import speech_onsets


def tones(sample_rate):
    """Return two seconds with a tone starting at .5, 1.0 and 1.5 s."""
    time = np.arange(2 * sample_rate) / sample_rate
    samples = np.zeros_like(time)
    for start in (0.5, 1.0, 1.5):
        on = (time >= start) & (time < start + 0.2)
        samples[on] = 0.5 * np.sin(2 * np.pi * 440 * time[on])
    return Audio(samples.astype(np.float32), sample_rate)


@pytest.mark.parametrize("sample_rate", [16000, 44100])
def test_onsets_are_where_sounds_begin_at_any_rate(sample_rate):
    onsets = speech_onsets(tones(sample_rate))
    nearest = np.abs(np.subtract.outer([0.5, 1.0, 1.5], onsets)).min(axis=1)
    assert nearest.max() < 0.04


def test_silence_has_no_onset():
    assert speech_onsets(Audio(np.zeros(16000, np.float32), 16000)).shape == (0,)


def test_real_speech_has_a_few_onsets_a_second(shared_data):
    speech = read_audio(shared_data / "2_scott_0_1_1.wav").cut(0.0, 20.0)
    onsets = speech_onsets(speech)
    assert 2 * 20 < len(onsets) < 10 * 20
    assert np.all(np.diff(onsets) > 0)
    assert 0 <= onsets[0] < onsets[-1] <= 20
