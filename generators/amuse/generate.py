"""AMUSE as a generator: speech in, a clip of the body out; parts of the speech can be swapped."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor

from generators.amuse.config import FRAME_RATE, LABELS, PARTS, STEPS
from generators.amuse.network_file import MotionNetworks, SpeechNetwork, load_motion, load_speech
from generators.interface import OnPart, SpeechSegment, seeded_stream
from generators.learned import NetworkGenerator, check_finite, network_facts
from generators.learned_settings import AmuseSettings
from generators.settings import content
from motion.audio import Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from training.hearing.speech_windows import WindowPlan, filterbanks_under, plan_windows
from training.layers.transformers import pack
from training.spaces.smplx_bodies import smplx_6d_clip

FADE: Final = 30
"""Frames in which a window takes over from the one before."""

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
        frames = plan.stride + FADE
        return smplx_6d_clip(motion[:wanted], FRAME_RATE), {
            "sampling": f"{STEPS} steps",
            **network_facts(
                self._settings, self._device, frames=frames, overlap=FADE, frame_rate=FRAME_RATE
            ),
            "speech_model": self._settings.speech_model.name,
            "strength": f"{self._settings.strength:g}",
            **{key: Path(named).name for key, named in self._named.items()},
        }

    @cached_property
    def _networks(self) -> MotionNetworks:
        networks = load_motion(self._settings.checkpoint)
        networks.model.to(self._device)
        return networks

    @cached_property
    def _speech(self) -> SpeechNetwork:
        file = self._settings.speech_model
        network, motion = load_speech(file), self._networks
        parts, told = network.model.parts, motion.model.config
        fits = (network.model.config.latent, len(parts)) == (told.condition_width, told.conditions)
        if not fits or motion.training.get("speech_model", content(file)) != content(file):
            raise InputError(
                "the denoiser was trained with another speech model, whose latents mean something "
                "else",
                where=file,
                remedy="Give the speech model that the denoiser was trained with",
            )
        for part in (_part_of(key) for key in self._named):
            if part not in parts:
                raise InputError(
                    f"the speech model does not take speech apart, so {part} cannot be another's",
                    where=file,
                    remedy=f"Leave out {part}, or give networks that learned from speech taken "
                    "apart",
                )
        pack(network.model.to(self._device))
        return network

    @cached_property
    def _named(self) -> dict[str, str | Path]:
        """The recordings and labels that stand in for parts of the speech, by their keys."""
        keys = (*PARTS, *(f"from_{part}" for part in LABELS))
        told = {key: getattr(self._settings, key) for key in keys}
        return {key: named for key, named in told.items() if named is not None}

    def _plan(self, audio: Audio) -> WindowPlan:
        frames = round(audio.duration * FRAME_RATE)
        return plan_windows(frames, self._networks.model.config.frames, FADE)

    def _latents(self, audio: Audio, plan: WindowPlan, on_part: OnPart) -> list[Tensor]:
        """Return content, emotion and style of each window, (windows, 1, latent) each."""
        model, strength = self._speech.model, self._settings.strength
        # What is shorter than the speech begins again.
        places = torch.arange(plan.count)
        named = {key: rows[places % len(rows)] for key, rows in self._heard_elsewhere.items()}
        own: dict[str, list[Tensor]] = {
            part: []
            for part in model.parts
            if part not in named
            or (part in LABELS and strength < 1 and f"from_{part}" not in named)
        }
        for number, rows in enumerate(self._windows(audio, plan), start=1):
            for part, heard in own.items():
                heard.append(model.latent(part, rows))
            on_part(number, plan.count)
        first = {part: torch.cat(heard) for part, heard in own.items()}
        last = first | named
        first = last | first | {_part_of(key): named[key] for key in named if key not in PARTS}
        return [torch.lerp(first[part], last[part], strength)[:, None] for part in model.parts]

    def _windows(self, audio: Audio, plan: WindowPlan) -> list[Tensor]:
        """Return the filterbank (1, rows, bands) of the speech under each window of motion."""
        config = self._speech.model.config
        windows = filterbanks_under(audio, plan, FRAME_RATE, config.frames, config.bands)
        return [rows.to(self._device) for rows in windows]

    @cached_property
    def _heard_elsewhere(self) -> dict[str, Tensor]:
        """Latents (windows, latent) of what stands in for parts of the speech, by their keys."""
        return {key: self._heard(_part_of(key), named) for key, named in self._named.items()}

    def _heard(self, part: str, named: str | Path) -> Tensor:
        """Return the content of a recording's windows; of emotion and style the mean."""
        if isinstance(named, str):
            return self._speech.labelled(part, named)[None].to(self._device)
        try:
            audio = read_audio(named)
            windows = self._windows(audio, self._plan(audio))
        except InputError as error:
            what = f"{part} cannot be heard: {error.what}"
            raise InputError(what, where=error.where or named, remedy=error.remedy) from error
        heard = torch.cat([self._speech.model.latent(part, rows) for rows in windows])
        return heard.mean(dim=0, keepdim=True) if part in LABELS else heard


def _part_of(key: str) -> str:
    return key.removeprefix("from_")
