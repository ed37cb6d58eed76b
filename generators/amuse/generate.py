"""AMUSE as a generator: speech in, a clip of the body out; parts of the speech can be swapped."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Final, cast

import numpy as np
import torch
from torch import Tensor

from generators.amuse.config import FRAME_RATE, PARTS, STEPS, Part
from generators.amuse.network_file import (
    MotionNetworks,
    SpeechNetwork,
    load_motion_networks,
    load_speech_network,
)
from generators.amuse.settings import AmuseSettings
from generators.interface import OnPart, SpeechSegment, seeded_stream
from generators.network_motion import NetworkGenerator, check_finite, network_facts
from generators.settings import content
from motion.audio import Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from training.joined_windows import WindowPlan, filterbanks_under, plan_windows
from training.layers.packing import pack
from training.spaces.smplx_6d import smplx_6d_clip

FADE: Final = 30
"""Frames in which a window takes over from the one before."""

_LEFT: Final = ("from_emotion", "from_style")
"""Keys of what emotion and style go from, by their strength."""

_AT_ONCE: Final = 8
"""Windows that are decoded together, so that memory does not grow with the speech."""


class Amuse(NetworkGenerator[AmuseSettings]):
    """Moves as the speech's content, emotion and style say (Chhatre et al. 2024)."""

    name = "amuse"
    version = "1"

    @torch.inference_mode()
    def made(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion and its facts.

        They are which recordings stood in for which parts, hashes of the weights, the device, and
        where windows of motion begin.
        """
        plan, model = self._plan(speech.audio), self._networks.model
        latents = self._latents(speech.audio, plan, on_part)
        random = np.random.default_rng(seeded_stream(seed))
        noise = random.standard_normal((plan.count, *model.prior.latent_shape)).astype(np.float32)
        z = model.sample(torch.from_numpy(noise).to(self._device), latents)
        windows = torch.cat([model.prior.decode(part) for part in torch.split(z, _AT_ONCE)])
        motion = plan.join(windows).cpu().numpy().astype(np.float64)
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
            **{key: Path(named).name for key, named in self._named.items()},
        }

    @cached_property
    def _networks(self) -> MotionNetworks:
        networks = load_motion_networks(self._settings.checkpoint)
        networks.model.to(self._device)
        return networks

    @cached_property
    def _speech(self) -> SpeechNetwork:
        network = load_speech_network(self._settings.speech_model)
        motion, found = self._networks, content(self._settings.speech_model)
        parts, told = network.model.parts, motion.model.config
        fits = (network.model.config.latent, len(parts)) == (told.condition_width, told.conditions)
        if not fits or motion.training.get("speech_model", found) != found:
            raise InputError(
                "the denoiser was trained with another speech model, whose latents mean something "
                "else",
                where=self._settings.speech_model,
                remedy="Give the speech model that the denoiser was trained with",
            )
        for part in (_part_of(key) for key in self._named):
            if part not in parts:
                raise InputError(
                    f"the speech model does not take speech apart, so {part} cannot be another's",
                    where=self._settings.speech_model,
                    remedy=f"Leave out {part}, or give networks that learned from speech taken "
                    "apart",
                )
        pack(network.model.to(self._device))
        return network

    @cached_property
    def _named(self) -> dict[str, str | Path]:
        """The recordings and labels that stand in for parts of the speech, by their keys."""
        told = ((key, getattr(self._settings, key)) for key in (*PARTS, *_LEFT))
        return {key: named for key, named in told if named is not None}

    def _plan(self, audio: Audio) -> WindowPlan:
        frames = round(audio.duration * FRAME_RATE)
        return plan_windows(frames, self._networks.model.config.frames, FADE)

    def _latents(self, audio: Audio, plan: WindowPlan, on_part: OnPart) -> list[Tensor]:
        """Return content, emotion and style of each window, (windows, 1, latent) each."""
        model, named = self._speech.model, self._named
        strength = self._settings.strength
        heard: dict[Part, list[Tensor]] = {
            part: []
            for part in model.parts
            if part not in named
            or (part != "content" and strength < 1 and f"from_{part}" not in named)
        }
        for number, rows in enumerate(self._windows(audio, plan)):
            for part, latents in heard.items():
                latents.append(model.latent(part, rows))
            on_part(number + 1, plan.count)
        own: dict[str, Tensor] = {part: torch.cat(latents) for part, latents in heard.items()}
        told = {key: self._stand_in(key, plan.count) for key in named}
        end = own | told
        left = {_part_of(key): latents for key, latents in told.items() if key in _LEFT}
        begin = end | own | left
        return [torch.lerp(begin[part], end[part], strength)[:, None] for part in model.parts]

    def _windows(self, audio: Audio, plan: WindowPlan) -> list[Tensor]:
        """Return the filterbank (1, rows, bands) of the speech under each window of motion."""
        config = self._speech.model.config
        windows = filterbanks_under(audio, plan, FRAME_RATE, config.frames, config.bands)
        return [rows.to(self._device) for rows in windows]

    def _stand_in(self, key: str, windows: int) -> Tensor:
        """Return the latents (windows, latent) of what stands in for a part of the speech.

        Content follows its recording, from its beginning again where it is shorter; emotion and
        style are the recording's mean.
        """
        latents = self._heard_elsewhere[key]
        if key != "content":
            return latents.mean(dim=0, keepdim=True).expand(windows, -1)
        return latents[torch.arange(windows) % len(latents)]

    @cached_property
    def _heard_elsewhere(self) -> dict[str, Tensor]:
        """Latents (windows, latent) of each recording or label that stands in for a part."""
        return {key: self._heard(_part_of(key), named) for key, named in self._named.items()}

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


def _part_of(key: str) -> Part:
    return cast("Part", key.removeprefix("from_"))
