"""The network as a walk through the noise asks it: plainly, or with all that is known prepared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

from generators.diffsheg.denoiser import Denoiser
from generators.diffsheg.walk import Sampling
from generators.diffsheg.window import Estimate


@dataclass(frozen=True, eq=False)
class SpeechFrames:
    """What is known of the speech, frame by frame.

    Attributes
    ----------
    mel : Tensor
        (frames, mel bands).
    hubert : Tensor
        (frames, speech features).
    """

    mel: Tensor
    hubert: Tensor

    def __len__(self) -> int:
        return len(self.mel)

    def part(self, first: int, last: int | None = None) -> SpeechFrames:
        """Return some of the frames."""
        return SpeechFrames(self.mel[first:last], self.hubert[first:last])

    def then(self, more: SpeechFrames) -> SpeechFrames:
        """Return these frames followed by `more`."""
        return SpeechFrames(torch.cat([self.mel, more.mel]), torch.cat([self.hubert, more.hubert]))


Told = Callable[[SpeechFrames], Estimate]
"""Tells a network the speech of a window."""


def plainly(denoiser: Denoiser, person: Tensor, sampling: Sampling) -> Told:
    """Return how to ask `denoiser` in full every time.

    Parameters
    ----------
    denoiser : Denoiser
        In evaluation mode.
    person : Tensor
        (speakers,), one-hot.
    sampling : Sampling
        How windows are walked.
    """

    def told(speech: SpeechFrames) -> Estimate:
        def estimate(noisy: Tensor, place: int) -> Tensor:
            step = torch.tensor([sampling.timesteps[place]])
            found: Tensor = denoiser(
                noisy, step, speech.mel[None], speech.hubert[None], person[None]
            )
            return found

        return estimate

    return told


def prepared(denoiser: Denoiser, person: Tensor, sampling: Sampling) -> Told:
    """Return how to ask `denoiser` with everything computed once that the motion does not change.

    What diffusion steps and speaker do to the blocks is the same for all windows; what the speech
    encoders say, for all steps of a window. It answers as `plainly` does, but for rounding.
    """
    steps = torch.tensor(sampling.timesteps)
    modulations = denoiser.modulate(steps, person[None])
    rows = [modulations.row(place) for place in range(len(steps))]

    def told(speech: SpeechFrames) -> Estimate:
        encoded = denoiser.encode(speech.hubert[None])
        heard: dict[int, dict[str, Tensor]] = {}

        def estimate(noisy: Tensor, place: int) -> Tensor:
            if place not in heard:
                heard[place] = denoiser.hear(speech.mel[None], encoded, rows[place])
            return denoiser.denoise(noisy, steps[place : place + 1], heard[place], rows[place])

        return estimate

    return told
