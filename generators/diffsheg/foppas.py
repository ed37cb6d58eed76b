"""Motion to speech of any length, also while it is still being spoken (FOPPAS, section 3.5)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import numpy as np
import torch
from torch import Tensor

from generators.diffsheg.estimates import Mover
from generators.diffsheg.speech_frames import SpeechFrames
from generators.diffsheg.walk import Sampling
from generators.diffsheg.window import Window, draw_noise, shared_frames
from generators.interface import seeded_stream
from motion.errors import InputError

TOGETHER: Final = 4
"""Windows that are made together at most, where their speech is there: motion comes in between."""


def stream(
    speech: Iterable[SpeechFrames],
    mover: Mover,
    *,
    frames: int,
    width: int,
    sampling: Sampling,
    seed: int,
) -> Iterator[Tensor]:
    """Yield motion as soon as it is settled.

    How the speech is cut into pieces changes nothing: all of it at once gives the same motion.
    Of speech in small pieces, never more than a window and the shared frames are kept.

    Parameters
    ----------
    speech : iterable of SpeechFrames
        Pieces of any length, in order.
    mover : Mover
        The network; see `generators.diffsheg.estimates`.
    frames : int
        Frames of a window.
    width : int
        Values of a frame.
    sampling : Sampling
        How windows are walked, and how many frames they share.
    seed : int
        Not negative; the same seed gives the same motion.

    Yields
    ------
    Tensor
        (some frames, width), as many frames in all as the speech has.

    Raises
    ------
    InputError
        If windows would share all their frames.
    """
    if sampling.overlap >= frames:
        raise InputError(
            f"windows of {frames} frames cannot share {sampling.overlap} of them",
            remedy="Let windows share fewer frames than they have",
        )
    settled, number = frames - sampling.overlap, 0
    known: Tensor | None = None
    waiting: SpeechFrames | None = None

    def moved(parts: Sequence[SpeechFrames]) -> list[Tensor]:
        nonlocal number
        windows: list[Window] = []
        with torch.inference_mode():
            for part in parts:
                continues = known is not None or (bool(windows) and sampling.overlap > 0)
                shape = (len(part), width)
                noise = draw_noise(shape, sampling, _random(seed, number), continues=continues)
                windows.append(Window(part, noise))
                number += 1
            return mover(windows, known)

    for piece in speech:
        waiting = piece if waiting is None else waiting.then(piece)
        while len(waiting) >= frames:
            count = min(1 + (len(waiting) - frames) // settled, TOGETHER)
            begins = range(0, count * settled, settled)
            motions = moved([waiting.part(begin, begin + frames) for begin in begins])
            waiting = waiting.part(count * settled)
            known = shared_frames(motions[-1], sampling)
            yield from (motion[:settled] for motion in motions)
    if waiting is None:
        return
    if known is not None and len(waiting) == len(known):
        yield known
    elif len(waiting):
        yield from moved([waiting])


def _random(seed: int, number: int) -> torch.Generator:
    """Return what the noise of a window is drawn from."""
    entropy = np.random.SeedSequence(seeded_stream(seed, "foppas", str(number)))
    return torch.Generator().manual_seed(int(entropy.generate_state(1, np.uint64)[0]))
