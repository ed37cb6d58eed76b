"""The network as a walk through the noise asks it: plainly, or with all that is known prepared."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from generators.diffsheg.denoiser import Denoiser
from generators.diffsheg.prepared_denoiser import PreparedDenoiser
from generators.diffsheg.speech_frames import SpeechFrames
from generators.diffsheg.walk import Sampling
from generators.diffsheg.window import Estimate, Window, sample_windows

Mover = Callable[[Sequence[Window], Tensor | None], list[Tensor]]
"""Makes the motion, (frames, values), of windows that continue each other, in order.

Also given are the frames that the first window continues, if any.
"""


def plainly(denoiser: Denoiser, person: Tensor, sampling: Sampling) -> Mover:
    """Return how to ask `denoiser` in full every time.

    Parameters
    ----------
    denoiser : Denoiser
        In evaluation mode, on any device.
    person : Tensor
        (speakers,), one-hot.
    sampling : Sampling
        How windows are walked.
    """
    device = next(denoiser.parameters()).device

    def told(speech: SpeechFrames) -> Estimate:
        conditions = [one[None].to(device) for one in (speech.mel, speech.hubert, person)]

        def estimate(noisy: Tensor, place: int) -> Tensor:
            step = torch.tensor([sampling.timesteps[place]], device=device)
            found: Tensor = denoiser(noisy, step, *conditions)
            return found

        return estimate

    def moved(windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        asked = ((told(window.speech), window.noise.to(device)) for window in windows)
        return sample_windows(asked, sampling, known)

    return moved


def prepared(denoiser: Denoiser, person: Tensor, sampling: Sampling) -> Mover:
    """Return how to ask `denoiser` with everything computed once that the motion does not change.

    It moves as `plainly` does, but for rounding; see `PreparedDenoiser`.
    """
    with torch.inference_mode():
        network = PreparedDenoiser(denoiser, person, sampling)
    return network.moved
