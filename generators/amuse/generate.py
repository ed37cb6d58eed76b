"""AMUSE as a generator: speech in, a clip of the body out; parts of the speech can be swapped."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor

from generators.amuse.config import FRAME_RATE, PARTS, Part, SpeechConfig
from generators.amuse.network_file import (
    MotionNetworks,
    SpeechNetwork,
    load_motion_networks,
    load_speech_network,
)
from generators.amuse.sampling import (
    STEPS,
    WindowPlan,
    join_windows,
    plan_windows,
    sample_windows,
)
from generators.amuse.settings import AmuseSettings
from generators.interface import OnPart, SpeechSegment, seeded_stream
from generators.network_motion import NetworkGenerator, check_finite, network_facts
from generators.settings import content
from motion.audio import SPEECH_RATE, Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from training.hearing.spectra import check_speech, filterbank
from training.hearing.speech_frames import at_speech_rate
from training.layers.packing import pack
from training.spaces.smplx_6d import smplx_6d_clip

FADE: Final = 30
"""Frames in which a window takes over from the one before."""


class Amuse(NetworkGenerator[AmuseSettings]):
    """Moves as the speech's content, emotion and style say (Chhatre et al. 2024)."""

    name = "amuse"
    version = "1"

    def made(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion and its facts.

        They are which recordings stood in for which parts, hashes of the weights, the device, and
        where windows of motion begin.
        """
        plan = self._plan(speech.audio)
        latents = self._latents(speech.audio, plan, on_part)
        random = np.random.default_rng(seeded_stream(seed))
        noise = random.standard_normal((plan.count, *self._networks.prior.latent_shape))
        windows = sample_windows(
            self._networks.prior,
            self._networks.denoiser,
            latents,
            torch.from_numpy(noise.astype(np.float32)).to(self._device),
        )
        motion = join_windows(windows, plan).cpu().numpy().astype(np.float64)
        check_finite(motion, self._settings.checkpoint)
        wanted = max(1, round(speech.audio.duration * FRAME_RATE))
        return smplx_6d_clip(motion[:wanted], FRAME_RATE), {
            "sampling": f"{STEPS} steps",
            **network_facts(
                self._settings,
                self._device,
                frames=plan.stride + FADE,
                overlap=FADE,
                frame_rate=FRAME_RATE,
            ),
            "speech_model": self._settings.speech_model.name,
            "strength": f"{self._settings.strength:g}",
            **{part: Path(named).name for part, named in self._swapped.items()},
            **{f"from_{part}": Path(named).name for part, named in self._left.items()},
        }

    @cached_property
    def _networks(self) -> MotionNetworks:
        networks = load_motion_networks(self._settings.checkpoint)
        return replace(
            networks,
            prior=networks.prior.to(self._device),
            denoiser=networks.denoiser.to(self._device),
        )

    @cached_property
    def _speech(self) -> SpeechNetwork:
        network = load_speech_network(self._settings.speech_model)
        motion, found = self._networks, content(self._settings.speech_model)
        expected = (motion.prior.config.condition_width, motion.prior.config.conditions)
        if (
            network.model.config.latent,
            len(network.model.parts),
        ) != expected or motion.training.get("speech_model", found) != found:
            raise InputError(
                "the denoiser was trained with another speech model, whose latents mean something "
                "else",
                where=self._settings.speech_model,
                remedy="Give the speech model that the denoiser was trained with",
            )
        for part in self._swapped.keys() - set(network.model.parts):
            raise InputError(
                f"the speech model does not take speech apart, so {part} cannot be another's",
                where=self._settings.speech_model,
                remedy=f"Leave out {part}, or give networks that learned from speech taken apart",
            )
        pack(network.model.to(self._device))
        return network

    @cached_property
    def _swapped(self) -> dict[Part, str | Path]:
        """The recordings and labels that stand in for parts of the speech."""
        named = ((part, getattr(self._settings, part)) for part in PARTS)
        return {part: stands_in for part, stands_in in named if stands_in is not None}

    @cached_property
    def _left(self) -> dict[Part, str | Path]:
        """The recordings and labels that emotion and style go from, by their strength."""
        named = ((part, getattr(self._settings, f"from_{part}", None)) for part in PARTS)
        return {part: stands_in for part, stands_in in named if stands_in is not None}

    def _plan(self, audio: Audio) -> WindowPlan:
        frames = round(audio.duration * FRAME_RATE)
        return plan_windows(frames, self._networks.prior.config.frames, FADE)

    @torch.inference_mode()
    def _latents(self, audio: Audio, plan: WindowPlan, on_part: OnPart) -> list[Tensor]:
        """Return content, emotion and style of each window, (windows, latent) each."""
        parts = self._speech.model.parts
        begin, end = (
            {part: self._stand_in(part, named, plan.count) for part, named in side.items()}
            for side in (self._left, self._swapped)
        )
        strengths = {part: 1.0 if part == "content" else self._settings.strength for part in end}
        own = [part for part in parts if part not in begin and strengths.get(part, 0) < 1]
        heard: dict[Part, list[Tensor]] = {part: [] for part in own}
        for number, rows in enumerate(self._windows(audio, plan)):
            for part in own:
                heard[part].append(self._speech.model.latent(part, rows))
            on_part(number + 1, plan.count)
        begin |= {part: torch.cat(latents) for part, latents in heard.items()}
        begin, end = end | begin, begin | end
        return [torch.lerp(begin[part], end[part], strengths.get(part, 0.0)) for part in parts]

    def _windows(self, audio: Audio, plan: WindowPlan) -> list[Tensor]:
        windows = heard_windows(audio, plan, self._speech.model.config)
        return [rows.to(self._device) for rows in windows]

    def _stand_in(self, part: Part, named: str | Path, windows: int) -> Tensor:
        """Return the latents (windows, latent) of what stands in for a part of the speech.

        Content follows its recording, from its beginning again where it is shorter; emotion and
        style are the recording's mean.
        """
        latents = self._heard_elsewhere[part, named]
        if part != "content":
            return latents.mean(dim=0, keepdim=True).expand(windows, -1)
        return latents[torch.arange(windows) % len(latents)]

    @cached_property
    def _heard_elsewhere(self) -> dict[tuple[Part, str | Path], Tensor]:
        """Latents (windows, latent) of each recording or label that stands in for a part."""
        named = (*self._swapped.items(), *self._left.items())
        return {one: self._heard(*one) for one in named}

    def _heard(self, part: Part, named: str | Path) -> Tensor:
        if isinstance(named, str):
            return self._speech.labelled(part, named)[None].to(self._device)
        try:
            audio = read_audio(named)
            windows = self._windows(audio, self._plan(audio))
        except InputError as error:
            raise InputError(
                f"{part} cannot be heard: {error.what}",
                where=error.where or named,
                remedy=error.remedy,
            ) from error
        return torch.cat([self._speech.model.latent(part, rows) for rows in windows])


def heard_windows(audio: Audio, plan: WindowPlan, config: SpeechConfig) -> list[Tensor]:
    """Return the filterbank (1, rows, bands) of the speech under each window of motion.

    Raises
    ------
    InputError
        If the speech is shorter than half a second, or silent.
    """
    samples = at_speech_rate(audio)
    check_speech(samples)
    per_frame = SPEECH_RATE / FRAME_RATE
    windows = []
    for start in plan.starts:
        first, last = round(start * per_frame), round((start + plan.frames) * per_frame)
        windows.append(filterbank(samples[first:last], config.frames, config.bands)[None])
    return windows
