"""Speech2UnifiedExpressions: generator, discriminator and phoneme predictor (section 3.3)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from generators.s2ue.config import NetworkConfig
from motion.formats.ted_npz import BONES
from training.graph_convolution import ComponentEncoder
from training.spaces.anatomy import (
    BODY_EDGES,
    BODY_PARTS,
    bone_graph,
    component_graph,
    face_graph,
)
from training.spaces.bone_tensors import points_of, split_motion
from training.spaces.bones_and_landmarks import BONE_VALUES
from training.speaker_latent import SpeakerEncoder
from training.temporal_layers import Decoder, over_time

FloatArray = NDArray[np.float32]
Motion = Mapping[str, Tensor]
"""``face`` (B, T, L, 3) and ``pose`` (B, T, 9, 3), those that there are."""


def expression_encoder(
    config: NetworkConfig, neutral: FloatArray, modality: str, frames: tuple[int, int]
) -> ComponentEncoder:
    """Return the encoder of faces or of poses; generator and discriminator have each their own."""
    if modality == "face":
        parts = config.components
        edges = face_graph(parts, neutral)
        higher = component_graph(len(parts), pose=False) if config.face_graph else None
    else:
        parts, edges = BODY_PARTS, bone_graph(config.hops)
        higher = BODY_EDGES if config.pose_graph else None
    widths = (config.node_width, config.part_width, config.width_of((modality,)))
    return ComponentEncoder(edges, parts, higher, frames, widths, config.reach)


class Synthesis(nn.Module):
    """Motion of some modalities from one embedding of all that is given (section 3.3.3)."""

    def __init__(
        self, config: NetworkConfig, neutral: FloatArray, modalities: tuple[str, ...]
    ) -> None:
        super().__init__()
        hidden = config.hidden
        self.audio = nn.Sequential(
            over_time(config.sound, hidden, 5),
            over_time(hidden, hidden, 5),
            nn.Conv1d(hidden, config.audio_width, 3, padding=1),
        )
        text = config.text_width
        self.text = nn.Sequential(
            nn.Conv1d(config.words, text, 1),
            *(over_time(text, text, 3, dilation) for dilation in (1, 2, 4, 8)),
        )
        self.speaker = SpeakerEncoder(config.speakers, config.speaker_width)
        frames = (config.seeds, config.frames)
        self.seeds = nn.ModuleDict(
            {name: expression_encoder(config, neutral, name, frames) for name in modalities}
        )
        width = config.audio_width + text + config.speaker_width
        width += config.width_of(modalities)
        values = {"face": 3 * config.landmarks, "pose": 3 * len(BONES)}
        self.decoders = nn.ModuleDict(
            {name: Decoder(width, hidden, values[name]) for name in modalities}
        )

    def forward(
        self, sound: Tensor, words: Tensor, person: Tensor, noise: Tensor, seeds: Motion
    ) -> tuple[dict[str, Tensor], tuple[Tensor, Tensor]]:
        """Return the motion, and mean and variance of the speaker's latent; see `Generator`."""
        mean, variance = self.speaker(person)
        latent = mean + noise * (0.5 * variance).exp()
        embedding = torch.cat(
            [
                self.audio(sound.transpose(1, 2)).transpose(1, 2),
                self.text(words.transpose(1, 2)).transpose(1, 2),
                latent[:, None].expand(-1, sound.shape[1], -1),
                *(encode(seeds[name]) for name, encode in self.seeds.items()),
            ],
            dim=-1,
        )
        found = {name: points_of(decode(embedding)) for name, decode in self.decoders.items()}
        return found, (mean, variance)


class Generator(nn.Module):
    """Faces and poses of the speech, in one network or, without synchrony, in two."""

    def __init__(self, config: NetworkConfig, neutral: FloatArray) -> None:
        super().__init__()
        self.networks = nn.ModuleList(
            Synthesis(config, neutral, modalities) for modalities in config.modalities
        )

    def forward(
        self, sound: Tensor, words: Tensor, person: Tensor, noise: Tensor, seeds: Motion
    ) -> tuple[dict[str, Tensor], list[tuple[Tensor, Tensor]]]:
        """Return normalised motion, and the latents of who speaks.

        Parameters
        ----------
        sound, words : Tensor
            (B, T, 84) normalised MFCC; (B, T, 300) vectors of words.
        person : Tensor
            (B, K), one-hot, or shares of several speakers.
        noise : Tensor
            (B, networks, D_k), normal: where around a speaker the latent lies.
        seeds : mapping
            Normalised motion of the first frames, see `Motion`.
        """
        motion: dict[str, Tensor] = {}
        latents = []
        for number, network in enumerate(self.networks):
            found, latent = network(sound, words, person, noise[:, number], seeds)
            motion |= found
            latents.append(latent)
        return motion, latents


class Discriminator(nn.Module):
    """Whether motion is recorded, by its expressions; each network of the generator has one."""

    def __init__(self, config: NetworkConfig, neutral: FloatArray) -> None:
        super().__init__()
        frames = (config.frames, config.frames)
        self.encoders = nn.ModuleList(
            nn.ModuleDict(
                {name: expression_encoder(config, neutral, name, frames) for name in modalities}
            )
            for modalities in config.modalities
        )
        self.classes = nn.ModuleList(
            nn.Sequential(
                nn.Flatten(),
                nn.Linear(config.frames * config.width_of(modalities), config.hidden),
                nn.LeakyReLU(0.1),
                nn.Linear(config.hidden, 1),
            )
            for modalities in config.modalities
        )

    def forward(self, motion: Motion) -> Tensor:
        """Return logits of being recorded, (B, networks)."""
        found = []
        for encoders, classify in zip(self.encoders, self.classes, strict=True):
            if not isinstance(encoders, nn.ModuleDict):
                raise TypeError("encoders lie by modality")
            latents = [encode(motion[name]) for name, encode in encoders.items()]
            found.append(classify(torch.cat(latents, dim=-1)))
        return torch.cat(found, dim=1)


class PhonemePredictor(nn.Module):
    """Where the lips are for what is heard (equation 15): convolutions, then full layers."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        hidden = config.hidden
        self.backbone = nn.Sequential(
            over_time(config.bands, hidden, 3),
            over_time(hidden, hidden, 3),
            over_time(hidden, hidden, 3),
        )
        self.full = nn.Sequential(
            nn.Linear(hidden, hidden), nn.LeakyReLU(0.1), nn.Linear(hidden, 3 * len(config.lips))
        )

    def forward(self, spectrogram: Tensor) -> Tensor:
        """Return normalised landmarks of the lips, (B, T, lips, 3), of (B, T, bands)."""
        heard = self.backbone(spectrogram.transpose(1, 2)).transpose(1, 2)
        return points_of(self.full(heard))


class Network(nn.Module):
    """All networks, and what of the recordings they stand on.

    Parameters
    ----------
    config : NetworkConfig
        Their sizes.
    neutral : ndarray, shape (L, 3)
        Landmarks of the neutral face, metres.
    """

    neutral: Tensor
    mean: Tensor
    deviation: Tensor
    spread: Tensor
    rest: Tensor
    sound: Tensor
    spectrum: Tensor

    def __init__(self, config: NetworkConfig, neutral: FloatArray) -> None:
        super().__init__()
        self.config = config
        self.generator = Generator(config, neutral)
        self.discriminator = Discriminator(config, neutral)
        self.phonemes = PhonemePredictor(config)
        values = BONE_VALUES + 3 * config.landmarks
        self.register_buffer("neutral", torch.from_numpy(np.asarray(neutral, np.float32)))
        self.register_buffer("mean", torch.zeros(values))
        self.register_buffer("deviation", torch.ones(values))
        self.register_buffer("spread", torch.ones(3))  # of landmarks, directions, joints
        self.register_buffer("rest", torch.zeros(values))  # the mean first frame of recordings
        for name, width in (("sound", config.sound), ("spectrum", config.bands)):
            self.register_buffer(name, torch.stack([torch.zeros(width), torch.ones(width)]))

    def normalised(self, values: Tensor) -> Tensor:
        """Return values of motion as the networks see them."""
        return (values - self.mean) / self.deviation

    def synthesise(
        self, sound: Tensor, words: Tensor, person: Tensor, noise: Tensor, seeds: Tensor
    ) -> tuple[Tensor, list[tuple[Tensor, Tensor]]]:
        """Return values of motion (B, T, 27 + 3 L), and latents; see `Generator`.

        What the network does not tell, as the face without faces, is the recordings' mean.
        """
        told, latents = self.generator(
            (sound - self.sound[0]) / self.sound[1],
            words,
            person,
            noise,
            split_motion(self.normalised(seeds)),
        )
        nothing = sound.new_zeros(*sound.shape[:2], len(self.mean))
        motion = split_motion(nothing) | told
        values = torch.cat([motion["pose"].flatten(-2), motion["face"].flatten(-2)], dim=-1)
        return self.mean + self.deviation * values, latents

    def lips(self, spectrogram: Tensor) -> Tensor:
        """Return shifts of the lips' landmarks, (B, T, lips, 3), metres."""
        found = self.phonemes((spectrogram - self.spectrum[0]) / self.spectrum[1])
        mean, deviation = (
            points_of(one[BONE_VALUES:])[list(self.config.lips)]
            for one in (self.mean, self.deviation)
        )
        told: Tensor = mean + deviation * found
        return told

    def with_lips(self, values: Tensor, lips: Tensor) -> Tensor:
        """Return motion whose lips, but for the corners, are those of the phoneme predictor."""
        if not self.config.faces:
            return values
        face = points_of(values[..., BONE_VALUES:]).clone()
        face[..., list(self.config.lips), :] = lips
        return torch.cat([values[..., :BONE_VALUES], face.flatten(-2)], dim=-1)

    def judged(self, values: Tensor) -> Tensor:
        """Return the discriminator's logits of values of motion, (B, networks)."""
        found: Tensor = self.discriminator(split_motion(self.normalised(values)))
        return found
