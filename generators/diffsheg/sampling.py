"""FOPPAS: motion of any length, window by window (section 3.5).

The unconditioned branch depends on itself alone. It samples all available windows on its own thread
and passes its estimates on: two threads that seldom wait are faster than two that share every small
matrix product.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from queue import SimpleQueue
from typing import Final

import numpy as np
import torch
from torch import Tensor, nn

from generators.diffsheg.config import BLEND_BELOW, CLEAN, Sampling
from generators.diffsheg.layers import FusedSpeech
from generators.diffsheg.model import Branch, Denoiser
from generators.interface import seeded_stream
from motion.errors import InputError
from training.device import side_by_side
from training.diffusion import LINEAR
from training.speech_features.speech_frames import SpeechFrames

Estimate = Callable[[Tensor, int], Tensor]
"""Predicts the noise in a noisy window, (1, frames, width), at a place of the walk."""

Sampler = Callable[[Sequence["Window"], Tensor | None], list[Tensor]]
"""Samples the motion, (frames, values), of consecutive windows. The second argument is the frames
that the first window continues, or None."""

MOST_WINDOWS_AT_ONCE: Final = 4
"""Largest number of windows that are sampled together if their speech is available; after each such
group, motion is yielded."""


def stream(
    speech: Iterable[SpeechFrames],
    sampler: Sampler,
    *,
    frames: int,
    width: int,
    sampling: Sampling,
    seed: int,
) -> Iterator[Tensor]:
    """Yield motion as soon as it is final.

    The division into chunks does not matter: all of the speech at once gives the same motion. If
    the chunks are small, at most a window and the shared frames are kept.

    Parameters
    ----------
    speech : iterable of SpeechFrames
        Chunks of any length, in order.
    sampler : Sampler
        The sampler.
    frames : int
        Frames of a window.
    width : int
        Number of values of a frame.
    sampling : Sampling
        The steps of windows, and the number of frames they share.
    seed : int
        Random seed, at least 0; equal seeds give equal motion.

    Yields
    ------
    Tensor
        (some frames, width); the total number of frames is that of the speech.

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
    stride, number = frames - sampling.overlap, 0
    shared: Tensor | None = None
    pending: SpeechFrames | None = None

    def sample(excerpts: Sequence[SpeechFrames]) -> list[Tensor]:
        nonlocal number
        windows: list[Window] = []
        with torch.inference_mode():
            for excerpt in excerpts:
                continues = shared is not None or (bool(windows) and sampling.overlap > 0)
                shape = (len(excerpt), width)
                noise = draw_noise(shape, sampling, _generator(seed, number), continues=continues)
                windows.append(Window(excerpt, noise))
                number += 1
            return sampler(windows, shared)

    for chunk in speech:
        pending = chunk if pending is None else pending.followed_by(chunk)
        while len(pending) >= frames:
            count = min(1 + (len(pending) - frames) // stride, MOST_WINDOWS_AT_ONCE)
            starts = range(0, count * stride, stride)
            motions = sample([pending.slice(start, start + frames) for start in starts])
            pending = pending.slice(count * stride)
            shared = shared_frames(motions[-1], sampling)
            yield from (motion[:stride] for motion in motions)
    if pending is None:
        return
    if shared is not None and len(pending) == len(shared):
        yield shared
    elif len(pending):
        yield from sample([pending])


def _generator(seed: int, number: int) -> torch.Generator:
    """Return the random generator of a window's noise."""
    entropy = np.random.SeedSequence(seeded_stream(seed, "foppas", str(number)))
    return torch.Generator().manual_seed(int(entropy.generate_state(1, np.uint64)[0]))


@dataclass(frozen=True, eq=False)
class Window:
    """The inputs of a window: equally many frames of speech and of noise.

    Attributes
    ----------
    speech : SpeechFrames
        Its speech.
    noise : sequence of Tensor
        All noise of its walk, drawn in advance so that its parts can be sampled separately, each
        (1, frames, values): at the start of the walk and, if it continues another window, for each
        step.
    """

    speech: SpeechFrames
    noise: Sequence[Tensor]


def draw_noise(
    shape: tuple[int, int], sampling: Sampling, random: torch.Generator, *, continues: bool
) -> list[Tensor]:
    """Draw the noise of a window of `shape`, frames and values, which may continue another one.

    It is drawn on the device of `random`, so that the motion does not depend on the network's.
    """
    steps = len(sampling.later_walk) - 1 if continues else 0
    return [torch.randn(1, *shape, generator=random) for _ in range(1 + steps)]


def sample_windows(
    windows: Iterable[tuple[Estimate, Sequence[Tensor]]], sampling: Sampling, shared: Tensor | None
) -> list[Tensor]:
    """Return the motion of consecutive windows; see `sample_window`."""
    motions = []
    for estimate, noise in windows:
        motions.append(sample_window(estimate, sampling, noise, shared))
        shared = shared_frames(motions[-1], sampling)
    return motions


def shared_frames(motion: Tensor, sampling: Sampling) -> Tensor | None:
    """Return the last frames of a window, which the next one continues; None without overlap."""
    return motion[-sampling.overlap :] if sampling.overlap else None


def sample_window(
    estimate: Estimate, sampling: Sampling, noise: Sequence[Tensor], shared: Tensor | None = None
) -> Tensor:
    """Return a window of motion, or a part of one.

    Parameters
    ----------
    estimate : Estimate
        The network's estimate for the window's speech.
    sampling : Sampling
        The sampling.
    noise : sequence of Tensor
        Noise for the values that `estimate` reads; see `Window.noise`.
    shared : Tensor, optional
        (overlap, values), the last frames of the previous window, which this window continues.

    Returns
    -------
    Tensor
        (frames, values); the first frames are `shared`, blended into the following ones.
    """
    walk = sampling.first_walk if shared is None else sampling.later_walk
    alpha_bar = _signal_variance(sampling)
    motion, *steps = noise
    later = iter(steps)
    if shared is not None and sampling.smooth:
        pose = torch.cat([shared, shared[-1:].expand(motion.shape[1] - len(shared), -1)])
        motion = np.sqrt(alpha_bar(walk[0])) * pose + np.sqrt(1 - alpha_bar(walk[0])) * motion
    for place, after in pairwise(walk):
        if after > place:
            share = alpha_bar(after) / alpha_bar(place)
            motion = np.sqrt(share) * motion + np.sqrt(1 - share) * next(later)
            continue
        eps = estimate(motion, place)
        x0_hat = (motion - np.sqrt(1 - alpha_bar(place)) * eps) / np.sqrt(alpha_bar(place))
        motion = np.sqrt(alpha_bar(after)) * x0_hat + np.sqrt(1 - alpha_bar(after)) * eps
        if shared is not None:
            spread = float(np.sqrt(1 - alpha_bar(after)))
            fresh = next(later)
            noise_ahead = (eps if sampling.smooth else fresh)[0, : len(shared)]
            noisy = np.sqrt(alpha_bar(after)) * shared + spread * noise_ahead
            weight = _blend_weight(shared, blends=spread < BLEND_BELOW)
            motion[0, : len(shared)] = weight * noisy + (1 - weight) * motion[0, : len(shared)]
    return motion[0]


def _signal_variance(sampling: Sampling) -> Callable[[int], float]:
    """Return a function for the share of the signal's variance at each place."""

    def alpha_bar(place: int) -> float:
        return 1.0 if place == CLEAN else float(LINEAR.alpha_bar[sampling.timesteps[place]])

    return alpha_bar


def _blend_weight(shared: Tensor, *, blends: bool) -> Tensor:
    """Return the weight of the previous window in each shared frame, (overlap, 1)."""
    overlap = len(shared)
    fade = torch.arange(overlap, dtype=torch.float32, device=shared.device) / max(overlap, 1)
    return (1 - fade if blends else torch.ones_like(fade))[:, None]


class WindowSampler:
    """Samples the motion of consecutive windows, for one speaker.

    Everything that does not depend on the motion is computed once. On a CPU, the network's weights
    get another memory layout, with the same values.

    Parameters
    ----------
    denoiser : Denoiser
        The denoiser, in evaluation mode, on any device.
    person : Tensor
        (speakers,), one-hot.
    sampling : Sampling
        The sampling.
    """

    def __init__(self, denoiser: Denoiser, person: Tensor, sampling: Sampling) -> None:
        self._denoiser, self._sampling = denoiser, sampling
        self._device = next(denoiser.parameters()).device
        self._t = torch.tensor(sampling.timesteps, device=self._device)
        self._on_cpu = self._device.type == "cpu"
        if self._on_cpu:
            transpose_weight_layout(denoiser)
        with torch.inference_mode():
            self._modulations = denoiser.modulate(self._t, person[None].to(self._device))

    def __call__(self, windows: Sequence[Window], shared: Tensor | None) -> list[Tensor]:
        """Return the motion of each window, (frames, values).

        Parameters
        ----------
        windows : sequence of Window
            Consecutive windows.
        shared : Tensor or None
            (overlap, values), the frames that the first window continues.
        """
        denoiser = self._denoiser
        first, *others = denoiser.branches
        estimates: SimpleQueue[Tensor | BaseException | None] = SimpleQueue()

        def pass_on(x_t: Tensor, eps: Tensor, t: Tensor) -> None:
            estimates.put(denoiser.estimate(x_t, eps, t))

        def receive() -> Tensor | None:
            estimate = estimates.get()
            if isinstance(estimate, BaseException):
                raise estimate
            return estimate

        def ahead() -> list[Tensor]:
            try:
                return self._sample(first, windows, shared, lambda: None, pass_on)
            except BaseException as error:
                estimates.put(error)
                raise

        if not others:
            return ahead()

        def behind() -> list[Tensor]:
            return self._sample(others[0], windows, shared, receive, lambda *_: None)

        branches = side_by_side(ahead, behind) if self._on_cpu else (ahead(), behind())
        return [
            denoiser.join_parts(dict(zip((first, *others), parts, strict=True)))
            for parts in zip(*branches, strict=True)
        ]

    def _sample(
        self,
        name: str,
        windows: Sequence[Window],
        shared: Tensor | None,
        x0_hat: Callable[[], Tensor | None],
        on_eps: Callable[[Tensor, Tensor, Tensor], None],
    ) -> list[Tensor]:
        """Return a branch's part of the motion of all windows.

        `x0_hat` returns the other branch's estimate for the next evaluation, and `on_eps` is called
        with x_t, eps and t of each.
        """
        part = self._denoiser.parts[name]
        branch = self._denoiser.ordered_branches[name]

        def eps(x_t: Tensor, place: int, speech: list[FusedSpeech]) -> Tensor:
            row = slice(place, place + 1)
            modulations = [block[row] for block in self._modulations[name]]
            fused_speech = [fused.rows(row) for fused in speech]
            result: Tensor = branch(x_t, self._t[row], modulations, fused_speech, x0_hat())
            on_eps(x_t, result, self._t[row])
            return result

        inputs = (
            (
                partial(eps, speech=self._encode_speech(branch, window)),
                [noise[..., part].to(self._device) for noise in window.noise],
            )
            for window in windows
        )
        return sample_windows(inputs, self._sampling, None if shared is None else shared[:, part])

    def _encode_speech(self, branch: Branch, window: Window) -> list[FusedSpeech]:
        """Return a branch's speech condition at each place of the window's walk."""
        places = self._sampling.entry if len(window.noise) > 1 else self._sampling.steps
        mel = window.speech.mel.to(self._device).expand(places, -1, -1)
        modulations = {"audio": [self._modulations["audio"][0][:places]]}
        audio = self._denoiser.encode_audio(mel, modulations)
        return branch.encode_speech(audio, window.speech.hubert.to(self._device)[None])


_PADDING: Final = 64
"""Padding between the weights of two inputs: strides of a power of two would cause cache misses."""


def transpose_weight_layout(network: nn.Module) -> None:
    """Store the weights of all linear layers input by input, as products with few frames need them.

    If they are stored output by output, such products spend part of their time on reordering.
    """
    for layer in network.modules():
        if isinstance(layer, nn.Linear) and layer.weight.is_contiguous():
            weight = layer.weight.data
            room = torch.empty(weight.shape[1], weight.shape[0] + _PADDING, dtype=weight.dtype)
            layer.weight.data = room[:, : weight.shape[0]].copy_(weight.t()).t()
