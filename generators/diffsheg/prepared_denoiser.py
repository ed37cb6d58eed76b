"""A network for one speaker and one walk, with everything computed once that motion leaves alone.

The branch that is told nothing of the other one depends on nothing but itself. Over all windows
that are asked for it walks ahead on a thread of its own, and hands on what it hears and its
estimates of the clean motion: two threads that seldom wait work more than two that share every
small product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from queue import SimpleQueue
from types import MappingProxyType
from typing import Final

import torch
from torch import Tensor

from generators.diffsheg.config import Flow
from generators.diffsheg.denoiser import Branch, Denoiser
from generators.diffsheg.prepared_branch import Conditions, PreparedBranch
from generators.diffsheg.shared_threads import side_by_side
from generators.diffsheg.walk import Sampling
from generators.diffsheg.window import Estimate, Window, WindowNoise, sample_windows
from generators.diffusion import LINEAR

_ORDER: Final[Mapping[Flow, tuple[str, ...]]] = MappingProxyType(
    {
        "expression_to_gesture": ("expression", "gesture"),
        "gesture_to_expression": ("gesture", "expression"),
        "none": ("expression", "gesture"),
        "joint": ("whole",),
    }
)
"""The branches of each flow, who tells before who is told."""


class PreparedDenoiser:
    """Makes windows as the plain network does, but for rounding, in less time.

    Parameters
    ----------
    denoiser : Denoiser
        In evaluation mode, on any device.
    person : Tensor
        (speakers,), one-hot.
    sampling : Sampling
        How windows are walked.
    """

    def __init__(self, denoiser: Denoiser, person: Tensor, sampling: Sampling) -> None:
        config = denoiser.config
        self._denoiser, self._sampling = denoiser, sampling
        self._device = next(denoiser.parameters()).device
        self._steps = torch.tensor(sampling.timesteps, device=self._device)
        self._modulations = denoiser.modulate(self._steps, person[None].to(self._device))
        heard = 2 * config.audio_width + config.speech_width
        self._branches = {
            name: PreparedBranch(branch, self._modulations.branches[name], heard)
            for name, branch in denoiser.branches.items()
            if isinstance(branch, Branch)
        }
        self._order = _ORDER[config.flow]
        self._tells = config.flow in {"expression_to_gesture", "gesture_to_expression"}
        body = slice(0, config.gesture_width)
        face = slice(config.gesture_width, config.motion_width)
        self._on_processor = self._device.type == "cpu"
        self._values = {"gesture": body, "expression": face, "whole": slice(None)}

    def moved(self, windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        """Return the motion of windows that continue each other, each (frames, values).

        Parameters
        ----------
        windows : sequence of Window
            In order.
        known : Tensor or None
            (overlap, values), what the first window continues.
        """
        handed_on: SimpleQueue[Tensor | BaseException] = SimpleQueue()
        leads, *follow = self._order

        def conditions_ahead(window: Window, places: int) -> Conditions:
            heard = self._heard(window, places)
            for name in follow:
                handed_on.put(heard[name])
            return self._branches[leads].hear(heard[leads])

        def found_ahead(noisy: Tensor, place: int, conditions: Conditions) -> Tensor:
            found = self._found(leads, noisy, place, conditions)
            if self._tells:
                step = self._steps[place : place + 1]
                handed_on.put(LINEAR.clean(noisy, found, step)[0])
            return found

        def ahead() -> list[Tensor]:
            try:
                return self._walked(leads, windows, known, conditions_ahead, found_ahead)
            except BaseException as error:
                handed_on.put(error)
                raise

        if not follow:
            return ahead()
        follows = self._branches[follow[0]]

        def conditions_behind(_window: Window, _places: int) -> Conditions:
            return follows.hear(_received(handed_on))

        def found_behind(noisy: Tensor, place: int, conditions: Conditions) -> Tensor:
            if self._tells:
                conditions = follows.tell(conditions, _received(handed_on))
            return self._found(follow[0], noisy, place, conditions)

        def behind() -> list[Tensor]:
            return self._walked(follow[0], windows, known, conditions_behind, found_behind)

        parts = side_by_side(ahead, behind) if self._on_processor else (ahead(), behind())
        of = dict(zip(self._order, parts, strict=True))
        return [
            torch.cat(window, dim=-1)
            for window in zip(of["gesture"], of["expression"], strict=True)
        ]

    def _heard(self, window: Window, places: int) -> dict[str, Tensor]:
        """Return what each branch is told of the speech at the first `places` of the walk."""
        mel, hubert = window.speech.mel.to(self._device), window.speech.hubert.to(self._device)
        speech = self._denoiser.encode(hubert[None])
        return self._denoiser.hear(
            mel.expand(places, -1, -1),
            {name: one.expand(places, -1, -1) for name, one in speech.items()},
            self._modulations.part(slice(0, places)),
        )

    def _walked(
        self,
        name: str,
        windows: Sequence[Window],
        known: Tensor | None,
        conditions_of: Callable[[Window, int], Conditions],
        found: Callable[[Tensor, int, Conditions], Tensor],
    ) -> list[Tensor]:
        """Return a branch's part of the motion of all windows."""
        sampling, values = self._sampling, self._values[name]

        def asked() -> Iterator[tuple[Estimate, WindowNoise]]:
            for window in windows:
                places = sampling.entry if window.noise.continues else sampling.steps
                told = conditions_of(window, places)

                def estimate(noisy: Tensor, place: int, told: Conditions = told) -> Tensor:
                    return found(noisy, place, told.at(place))

                yield estimate, window.noise.part(values).to(self._device)

        return sample_windows(asked(), sampling, None if known is None else known[:, values])

    def _found(self, name: str, noisy: Tensor, place: int, conditions: Conditions) -> Tensor:
        """Return the noise in a branch's part of the motion, (1, frames, part)."""
        answer = self._branches[name].answer(noisy, place, conditions)
        return self._denoiser.noise_of(name, answer, noisy, self._steps[place : place + 1])


def _received(handed_on: SimpleQueue[Tensor | BaseException]) -> Tensor:
    """Return what comes next, or raise what kept the other branch from making it."""
    told = handed_on.get()
    if isinstance(told, BaseException):
        raise told
    return told
