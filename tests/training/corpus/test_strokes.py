from __future__ import annotations

import numpy as np
import pytest

from training.corpus.heard_speech import HeardSpeech
from training.corpus.strokes import find_strokes, stroke_shape


def speech_with_humps(peaks: dict[float, float], seconds: float = 4.0) -> HeardSpeech:
    """Return speech whose loudness has a hump of 0.2 s at each of the times, so high."""
    times = np.arange(round(100 * seconds)) / 100
    loudness = np.zeros(len(times))
    for moment, height in peaks.items():
        loudness += height * np.exp(-0.5 * ((times - moment) / 0.05) ** 2)
    nothing = np.zeros(len(times))
    return HeardSpeech(
        loudness=loudness,
        slow_loudness=nothing,
        pitch=nothing,
        sounding=nothing,
        brightness=nothing,
    )


def test_a_stroke_arrives_where_the_voice_rises_to_a_loud_syllable() -> None:
    found = find_strokes(speech_with_humps({1.0: 0.9, 2.5: 0.7}), spacing=0.4)
    # A Gaussian rises fastest one sigma before its peak.
    np.testing.assert_allclose(found.times, [0.95, 2.45], atol=0.011)
    np.testing.assert_allclose(found.sizes, [1.6 * (0.9 - 0.35), 1.6 * (0.7 - 0.35)], rtol=1e-3)


def test_of_near_syllables_the_louder_gets_the_stroke() -> None:
    found = find_strokes(speech_with_humps({1.0: 0.7, 1.3: 0.9, 2.5: 0.6}), spacing=0.5)
    np.testing.assert_allclose(found.times, [1.25, 2.45], atol=0.011)


def test_quiet_syllables_and_silence_get_none() -> None:
    assert not len(find_strokes(speech_with_humps({1.0: 0.3}), spacing=0.4).times)
    assert not len(find_strokes(speech_with_humps({}), spacing=0.4).times)


def test_a_stroke_goes_out_and_back_from_rest_to_rest() -> None:
    since = np.linspace(-0.5, 0.8, 1301)
    shape = stroke_shape(since, 0.3, 0.5)
    speed = np.gradient(shape, since)
    assert shape.max() == pytest.approx(1)
    assert since[shape.argmax()] == pytest.approx(0, abs=1e-9)
    assert not shape[(since <= -0.3) | (since >= 0.5)].any()
    for still in (-0.3, 0.0, 0.5):
        assert abs(speed[np.argmin(np.abs(since - still))]) < 0.02
    # Minimum jerk: 1.875 times the mean speed, halfway.
    assert speed.max() == pytest.approx(1.875 / 0.3, rel=1e-3)
