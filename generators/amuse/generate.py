"""AMUSE as a generator: speech in, a clip of the body out; parts of the speech can be swapped."""

from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor

from generators.amuse.config import FRAME_RATE, LABELS, PARTS, STEPS
from generators.amuse.network_file import MotionNetworks, SpeechNetwork, load_motion, load_speech
from generators.interface import OnPart, SpeechSegment, seeded_stream
from generators.learned import NetworkGenerator, check_finite, network_provenance
from generators.learned_settings import AmuseSettings
from generators.settings import content
from motion.audio import Audio, read_audio
from motion.clip import MotionClip
from motion.errors import InputError, found_at
from training.layers.transformers import pack
from training.spaces.smplx_bodies import smplx_6d_clip
from training.speech_features.speech_frames import WindowPlan, filterbanks_under, plan_windows

FADE: Final = 30
"""Frames over which a window fades in over the previous one."""

_AT_ONCE: Final = 8
"""Windows that are decoded together, so that memory does not grow with the speech."""


class Amuse(NetworkGenerator[AmuseSettings]):
    """Generates motion from the speech's content, emotion and style (Chhatre et al. 2024)."""

    name = "amuse"
    version = "2"

    @torch.inference_mode()
    def make_motion(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion and its facts.

        The facts are the recordings that replaced parts, hashes of the weights, the device, and the
        windows of motion.
        """
        plan, model = self._plan(speech.audio), self._networks.model
        latents = self._latents(speech, plan, on_part)
        random = np.random.default_rng(seeded_stream(seed))
        noise = random.standard_normal((plan.count, *model.prior.latent_shape)).astype(np.float32)
        z = model.sample(torch.from_numpy(noise).to(self._device), latents)
        windows = torch.cat([model.prior.decode(part) for part in torch.split(z, _AT_ONCE)])
        motion = plan.join(windows).cpu().numpy().astype(np.float64)
        check_finite(motion, self._settings.checkpoint)
        length = max(1, round(speech.audio.duration * FRAME_RATE))
        frames = plan.stride + FADE
        return smplx_6d_clip(motion[:length], FRAME_RATE), {
            "sampling": f"{STEPS} steps",
            **network_provenance(
                self._settings, self._device, frames=frames, overlap=FADE, frame_rate=FRAME_RATE
            ),
            "speech_model": self._settings.speech_model.name,
            "strength": f"{self._settings.strength:g}",
            **{key: Path(chosen).name for key, chosen in self._chosen.items()},
        }

    @cached_property
    def _networks(self) -> MotionNetworks:
        return load_motion(self._settings.checkpoint).to(self._device)

    @cached_property
    def _speech(self) -> SpeechNetwork:
        file = self._settings.speech_model
        network, motion = load_speech(file), self._networks
        parts, denoiser_config = network.model.parts, motion.model.config
        fits = (network.model.config.latent, len(parts)) == (
            denoiser_config.condition_width,
            denoiser_config.conditions,
        )
        if not fits or motion.training.get("speech_model", content(file)) != content(file):
            raise InputError(
                "the denoiser was trained with another speech model, whose latents are different",
                where=file,
                remedy="Give the speech model that the denoiser was trained with",
            )
        for part in (_part_of(key) for key in self._chosen):
            if part not in parts:
                raise InputError(
                    f"the speech model does not disentangle speech, so {part} cannot be replaced",
                    where=file,
                    remedy=f"Leave out {part}, or give networks of disentangled speech",
                )
        pack(network.model.to(self._device))
        return network

    @cached_property
    def _chosen(self) -> dict[str, str | Path]:
        """The recordings and labels that replace parts of the speech, by their keys."""
        keys = (*PARTS, *(f"from_{part}" for part in LABELS))
        values = {key: getattr(self._settings, key) for key in keys}
        return {key: value for key, value in values.items() if value is not None}

    def _plan(self, audio: Audio) -> WindowPlan:
        frames = round(audio.duration * FRAME_RATE)
        return plan_windows(frames, self._networks.model.config.frames, FADE)

    def _latents(self, speech: SpeechSegment, plan: WindowPlan, on_part: OnPart) -> list[Tensor]:
        """Return content, emotion and style of each window, (windows, 1, latent) each."""
        model, strength = self._speech.model, self._settings.strength
        # A recording that is shorter than the speech is repeated.
        positions = torch.arange(plan.count)
        chosen = {key: rows[positions % len(rows)] for key, rows in self._chosen_latents.items()}
        speech_latents: dict[str, list[Tensor]] = {
            part: []
            for part in model.parts
            if part not in chosen
            or (part in LABELS and strength < 1 and f"from_{part}" not in chosen)
        }
        windows = self._windows(speech.audio, plan, f"segment {speech.segment.name}")
        for number, rows in enumerate(windows, start=1):
            for part, parts_rows in speech_latents.items():
                parts_rows.append(model.latent(part, rows))
            on_part(number, plan.count)
        start = {part: torch.cat(parts_rows) for part, parts_rows in speech_latents.items()}
        end = start | chosen
        start = end | start | {_part_of(key): chosen[key] for key in chosen if key not in PARTS}
        return [torch.lerp(start[part], end[part], strength)[:, None] for part in model.parts]

    def _windows(self, audio: Audio, plan: WindowPlan, source: object) -> list[Tensor]:
        """Return the filterbank (1, rows, bands) of the speech under each window of motion."""
        config = self._speech.model.config
        with found_at(source):
            windows = filterbanks_under(audio, plan, FRAME_RATE, config.frames, config.bands)
        return [rows.to(self._device) for rows in windows]

    @cached_property
    def _chosen_latents(self) -> dict[str, Tensor]:
        """Latents (windows, latent) that replace parts of the speech, by their keys."""
        return {
            key: self._latents_of(_part_of(key), chosen) for key, chosen in self._chosen.items()
        }

    def _latents_of(self, part: str, chosen: str | Path) -> Tensor:
        """Return the content of a recording's windows, or the mean of its emotion or style."""
        if isinstance(chosen, str):
            return self._speech.labelled(part, chosen)[None].to(self._device)
        audio = read_audio(chosen)
        windows = self._windows(audio, self._plan(audio), chosen)
        latents = torch.cat([self._speech.model.latent(part, rows) for rows in windows])
        return latents.mean(dim=0, keepdim=True) if part in LABELS else latents


def _part_of(key: str) -> str:
    return key.removeprefix("from_")
