"""The filterbank that AMUSE's encoders read."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from motion.errors import InputError
from training.hearing.filterbank import check_speech, filterbank


def _tone(hertz: float, seconds: float) -> NDArray[np.float32]:
    times = np.arange(round(16_000 * seconds)) / 16_000
    return (0.5 * np.sin(2 * np.pi * hertz * times)).astype(np.float32)


def test_a_higher_tone_is_loudest_in_a_higher_band() -> None:
    loudest = [int(filterbank(_tone(hertz, 1.0))[10].argmax()) for hertz in (200, 800, 3200)]
    assert loudest == sorted(loudest)
    assert len(set(loudest)) == 3


def test_ten_seconds_have_998_rows_and_zeros_follow() -> None:
    rows = filterbank(_tone(440, 10.0))
    padding = 9.173025 / (2 * 5.062332)
    assert tuple(rows.shape) == (1024, 128)
    assert rows[998:].numpy() == pytest.approx(padding)
    assert (rows[:998] != rows[998]).any(dim=1).all()


def test_speech_twice_as_loud_lies_higher_by_the_logarithm_of_four() -> None:
    quiet, loud = (filterbank(gain * _tone(440, 1.0), rows=90) for gain in (0.25, 0.5))
    band = int(quiet[10].argmax())
    step = float(loud[10, band] - quiet[10, band])
    assert step == pytest.approx(np.log(4) / (2 * 5.062332), rel=1e-4)


@pytest.mark.parametrize(
    ("samples", "said"),
    [(_tone(440, 0.3), "0.30 s, too short"), (np.zeros(16_000, np.float32), "is silent")],
)
def test_what_holds_no_speech_is_refused(samples: NDArray[np.float32], said: str) -> None:
    with pytest.raises(InputError, match=said):
        check_speech(samples)
