"""Features of live speech equal those of the whole speech."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from motion.audio import Audio
from tests.support.sounds import noise
from training.speech_features.hubert import Hubert, stand_in
from training.speech_features.speech_frames import (
    LONG_SPEECH_WINDOW,
    SpeechFrames,
    StreamWindow,
    extract_all_frames,
    extract_frames,
    plan_windows,
    stream_frames,
    window_for,
)

WINDOW = StreamWindow(past=1, ahead=0.5)


@cache
def hubert() -> Hubert:
    return stand_in()


def streamed(
    pieces: list[np.ndarray], window: StreamWindow = WINDOW, rate: int = 15
) -> SpeechFrames:
    first, *others = stream_frames(pieces, rate, hubert(), window)
    for frames in others:
        first = first.followed_by(frames)
    return first


SPEECH = noise(3.3).samples


@pytest.fixture(scope="module")
def at_once(trained_shortly: None) -> SpeechFrames:
    """Return the features of all speech at once, with as many threads as in the tests."""
    return streamed([SPEECH])


@settings(max_examples=6, deadline=None)
@given(st.lists(st.integers(0, len(SPEECH)), max_size=6))
def test_chunking_of_speech_does_not_change_a_bit(at_once: SpeechFrames, cuts: list[int]) -> None:
    result = streamed(np.split(SPEECH, sorted(cuts)))
    assert torch.equal(result.mel, at_once.mel)
    assert torch.equal(result.hubert, at_once.hubert)


def test_a_window_over_all_speech_gives_the_features_of_each_moment() -> None:
    result = streamed([SPEECH], StreamWindow(past=4, ahead=4.0)).hubert
    vectors = hubert().features(SPEECH)
    frame = np.arange(0, len(result), 3)  # every third frame lies on a feature, 0.2 s apart
    torch.testing.assert_close(result[frame[:-1]], vectors[10 * frame[:-1] // 3])


@pytest.mark.parametrize("rate", [15, 30])
@pytest.mark.parametrize("seconds", [0.02, 0.4, 1.0, 1.04, 2.0, 2.5])
def test_the_number_of_frames_matches_the_speech(seconds: float, rate: int) -> None:
    audio = noise(seconds)
    count = sum(len(frames) for frames in stream_frames([audio.samples], rate, hubert(), WINDOW))
    assert count == round(seconds * rate)
    assert len(extract_all_frames(audio, rate, hubert())) == max(1, count)


def test_a_second_is_encoded_as_soon_as_its_context_is_known() -> None:
    given_out: list[int] = []

    def pieces() -> Iterator[np.ndarray]:
        for piece in np.split(noise(4).samples, 40):
            given_out.append(len(piece))
            yield piece

    frames = stream_frames(pieces(), 15, hubert(), WINDOW)
    assert len(next(frames)) == 15
    assert sum(given_out) == round(1.5 * 16000)
    assert len(next(frames)) == 15
    assert sum(given_out) == round(2.5 * 16000)


@pytest.mark.parametrize(
    ("second", "changed", "other_second"),
    [(2, slice(0, 16000), 1), (1, slice(round(2.5 * 16000), None), 2)],
    ids=["before", "after"],
)
def test_speech_outside_the_stated_window_changes_nothing(
    at_once: SpeechFrames, second: int, changed: slice, other_second: int
) -> None:
    other = SPEECH.copy()
    other[changed] = 0
    result = streamed([other])
    same, not_same = (slice(15 * one, 15 * one + 15) for one in (second, other_second))
    assert torch.equal(result.hubert[same], at_once.hubert[same])
    assert torch.equal(result.mel[same], at_once.mel[same])
    assert not torch.equal(result.hubert[not_same], at_once.hubert[not_same])


class Listening(torch.nn.Module):
    """A network of HuBERT's shape that records how much it gets at once."""

    def __init__(self) -> None:
        super().__init__()
        self.seconds: list[float] = []

    def forward(self, samples: torch.Tensor) -> SimpleNamespace:
        self.seconds.append(samples.shape[-1] / 16000)
        count = (samples.shape[-1] - 400) // 320 + 1
        places = torch.arange(count, dtype=torch.float32)[:, None]
        return SimpleNamespace(last_hidden_state=places.expand(1, count, 1024))


def test_long_speech_is_never_encoded_at_once() -> None:
    network = Listening()
    listening = replace(hubert(), network=network)
    audio = Audio(np.zeros(round(200.2 * 16000), np.float32), 16000)
    assert window_for(audio) == LONG_SPEECH_WINDOW
    parts = list(extract_frames(audio, 15, listening))
    assert sum(len(part) for part in parts) == round(200.2 * 15)
    assert max(network.seconds) == 68
    assert len(network.seconds) == 4
    # Positions count from the start of a part's context, 4 s before all but the first.
    assert float(parts[0].hubert[0, 0]) == 0
    assert float(parts[1].hubert[0, 0]) == 4 * 50


def test_long_speech_gives_the_same_features_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    audio = noise(6.5)
    whole = extract_all_frames(audio, 15, hubert()).mel
    module = "training.speech_features.speech_frames"
    monkeypatch.setattr(f"{module}.LONGEST_AT_ONCE", 4.0)
    short = StreamWindow(past=1, ahead=1.0, at_once=2)
    monkeypatch.setattr(f"{module}.LONG_SPEECH_WINDOW", short)
    result = torch.cat([part.mel for part in extract_frames(audio, 15, hubert())])
    torch.testing.assert_close(result, whole, rtol=1e-4, atol=1e-6)


@given(total=st.integers(1, 5000), frames=st.integers(40, 300), fade=st.integers(1, 30))
def test_windows_cover_the_speech_and_share_at_least_the_fade(
    total: int, frames: int, fade: int
) -> None:
    plan = plan_windows(total, frames, fade)
    assert plan.starts[-1] + frames >= total
    if plan.count > 1:
        assert frames - plan.stride >= fade
        assert plan.starts[-1] < total
        assert plan.starts[-1] + frames - total < plan.count - 1


def test_motion_cut_into_windows_is_reassembled() -> None:
    plan = plan_windows(95, 40, 6)
    motion = torch.randn(plan.starts[-1] + 40, 3)
    windows = torch.stack([motion[start : start + 40] for start in plan.starts])
    torch.testing.assert_close(plan.join(windows), motion)
