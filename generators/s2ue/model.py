"""Speech2UnifiedExpressions: generator, discriminator and phoneme predictor (section 3.3)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import torch
from torch import Tensor, nn

from generators.s2ue.config import NetworkConfig
from motion.body.face_landmarks import FaceLandmarks
from training.layers.convolutions import (
    BODY_EDGES,
    BODY_PARTS,
    ComponentEncoder,
    Decoder,
    bone_graph,
    component_graph,
    components_of,
    face_graph,
    lips_of,
    over_time,
)
from training.spaces.bones_and_landmarks import BONE_VALUES, as_points, split_motion
from training.speakers import SpeakerEncoder, Speakers
from training.weights_file import NetworkKind, TrainedNetwork

Motion = Mapping[str, Tensor]
"""``face`` (B, T, L, 3) and ``pose`` (B, T, 9, 3), or one of them."""

Latents = list[tuple[Tensor, Tensor]]
"""For each network, mean and log variance of the speaker's latent, (B, D_k)."""


def expression_encoders(
    config: NetworkConfig, face: FaceLandmarks, group: Sequence[str], frames: tuple[int, int]
) -> nn.ModuleDict:
    """Return encoders of faces and poses; generator and discriminator each have their own."""
    parts = components_of(face.actions)
    higher = component_graph(len(parts), pose=False)
    graphs = {
        "face": (face_graph(parts, face.neutral), parts, higher if config.face_graph else None),
        "pose": (bone_graph(config.hops), BODY_PARTS, BODY_EDGES if config.pose_graph else None),
    }
    return nn.ModuleDict(
        {
            name: ComponentEncoder(
                *graphs[name],
                frames,
                (config.node_width, config.part_width, config.width_of((name,))),
                config.reach,
            )
            for name in group
        }
    )


class Synthesis(nn.Module):
    """Generates some modalities of motion from one embedding of all inputs (section 3.3.3)."""

    def __init__(self, config: NetworkConfig, face: FaceLandmarks, group: tuple[str, ...]) -> None:
        super().__init__()
        hidden, text = config.hidden, config.text_width
        self.audio = nn.Sequential(
            over_time(config.sound, hidden, 5),
            over_time(hidden, hidden, 5),
            nn.Conv1d(hidden, config.audio_width, 3, padding=1),
        )
        self.text = nn.Sequential(
            nn.Conv1d(config.words, text, 1),
            *(over_time(text, text, 3, dilation) for dilation in (1, 2, 4, 8)),
        )
        self.speaker = SpeakerEncoder(config.speakers, config.speaker_width)
        frames = (config.seeds, config.frames)
        self.seeds = expression_encoders(config, face, group, frames)
        width = config.audio_width + text + config.speaker_width + config.width_of(group)
        values = {"face": 3 * face.count, "pose": BONE_VALUES}
        self.decoders = nn.ModuleDict(
            {name: Decoder(width, hidden, values[name]) for name in group}
        )

    def forward(
        self, sound: Tensor, words: Tensor, person: Tensor, noise: Tensor, seeds: Motion
    ) -> tuple[dict[str, Tensor], tuple[Tensor, Tensor]]:
        """Return normalised motion, and mean and log variance of the speaker's latent.

        Parameters
        ----------
        sound, words, person
            The same as for `Network.synthesise`; sound is normalised.
        noise : Tensor
            (B, D_k).
        seeds : mapping
            Normalised motion of the first frames.
        """
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
        motion = {name: as_points(decode(embedding)) for name, decode in self.decoders.items()}
        return motion, (mean, variance)


class Discriminator(nn.Module):
    """Classifies motion of some modalities as recorded or synthesised."""

    def __init__(self, config: NetworkConfig, face: FaceLandmarks, group: tuple[str, ...]) -> None:
        super().__init__()
        frames = config.frames
        self.encoders = expression_encoders(config, face, group, (frames, frames))
        self.classes = nn.Sequential(
            nn.Flatten(),
            nn.Linear(frames * config.width_of(group), config.hidden),
            nn.LeakyReLU(0.1),
            nn.Linear(config.hidden, 1),
        )

    def forward(self, motion: Motion) -> Tensor:
        """Return logits, (B, 1), for normalised motion being recorded."""
        latents = [encode(motion[name]) for name, encode in self.encoders.items()]
        logits: Tensor = self.classes(torch.cat(latents, dim=-1))
        return logits


class PhonemePredictor(nn.Module):
    """Predicts the lips from sound (equation 15): convolutions, then fully connected layers."""

    def __init__(self, config: NetworkConfig, lips: int) -> None:
        super().__init__()
        hidden = config.hidden
        self.backbone = nn.Sequential(
            over_time(config.bands, hidden, 3),
            *(over_time(hidden, hidden, 3) for _ in range(2)),
        )
        self.full = nn.Sequential(
            nn.Linear(hidden, hidden), nn.LeakyReLU(0.1), nn.Linear(hidden, 3 * lips)
        )

    def forward(self, spectrogram: Tensor) -> Tensor:
        """Return normalised landmarks of the lips, (B, T, lips, 3), for (B, T, bands)."""
        features = self.backbone(spectrogram.transpose(1, 2)).transpose(1, 2)
        return as_points(self.full(features))


class Network(nn.Module):
    """All networks, with the statistics of their recordings.

    Generator and discriminator are one network each or, without synchrony, one for faces and one
    for poses.

    Parameters
    ----------
    config : NetworkConfig
        Sizes of the networks.
    face : FaceLandmarks
        The landmarks.

    Attributes
    ----------
    lips : list of int
        Landmarks of the phoneme predictor: those of the lips without their corners.
    """

    mean: Tensor
    deviation: Tensor
    spread: Tensor
    rest: Tensor
    sound: Tensor
    spectrum: Tensor

    def __init__(self, config: NetworkConfig, face: FaceLandmarks) -> None:
        super().__init__()
        self.config = config
        self.lips = list(lips_of(face.actions))
        groups = config.modalities
        self.generator = nn.ModuleList(Synthesis(config, face, group) for group in groups)
        self.discriminator = nn.ModuleList(Discriminator(config, face, group) for group in groups)
        self.phonemes = PhonemePredictor(config, len(self.lips))
        values = BONE_VALUES + 3 * face.count
        self.register_buffer("neutral", torch.from_numpy(face.neutral))
        self.register_buffer("mean", torch.zeros(values))
        self.register_buffer("deviation", torch.ones(values))
        self.register_buffer("spread", torch.ones(3))  # of landmarks, directions, joints
        self.register_buffer("rest", torch.zeros(values))  # the mean first frame of recordings
        for name, width in (("sound", config.sound), ("spectrum", config.bands)):
            self.register_buffer(name, torch.stack([torch.zeros(width), torch.ones(width)]))

    def normalised(self, values: Tensor) -> Tensor:
        """Return normalised values of motion."""
        return (values - self.mean) / self.deviation

    def synthesise(
        self, sound: Tensor, words: Tensor, person: Tensor, noise: Tensor, seeds: Tensor
    ) -> tuple[Tensor, Latents]:
        """Return values of motion (B, T, 27 + 3 L), and the speakers' latents.

        A modality that the network does not generate is the recordings' mean.

        Parameters
        ----------
        sound, words : Tensor
            (B, T, 84) MFCC; (B, T, 300) word vectors.
        person : Tensor
            (B, K), one-hot.
        noise : Tensor
            (B, networks, D_k): noise of each network's latent, in standard deviations.
        seeds : Tensor
            (B, T_s, 27 + 3 L), values of motion of the first frames.
        """
        sound = (sound - self.sound[0]) / self.sound[1]
        motion = split_motion(sound.new_zeros(*sound.shape[:2], len(self.mean)))
        seed_motion, latents = split_motion(self.normalised(seeds)), []
        for network, latent_noise in zip(self.generator, noise.unbind(dim=1), strict=True):
            synthesised, latent = network(sound, words, person, latent_noise, seed_motion)
            motion |= synthesised
            latents.append(latent)
        values = torch.cat([motion["pose"].flatten(-2), motion["face"].flatten(-2)], dim=-1)
        return self.mean + self.deviation * values, latents

    def predict_lips(self, spectrogram: Tensor) -> Tensor:
        """Return shifts of the lips' landmarks, (B, T, lips, 3), in metres."""
        lips: Tensor = self.phonemes((spectrogram - self.spectrum[0]) / self.spectrum[1])
        mean, deviation = (
            as_points(s[BONE_VALUES:])[self.lips] for s in (self.mean, self.deviation)
        )
        return mean + deviation * lips

    def with_lips(self, values: Tensor, spectrogram: Tensor) -> Tensor:
        """Return motion with the lips, except their corners, from the phoneme predictor."""
        if not self.config.faces:
            return values
        face = as_points(values[..., BONE_VALUES:]).clone()
        face[..., self.lips, :] = self.predict_lips(spectrogram)
        return torch.cat([values[..., :BONE_VALUES], face.flatten(-2)], dim=-1)

    def discriminate(self, values: Tensor) -> Tensor:
        """Return the discriminator's logits of values of motion, (B, networks)."""
        motion = split_motion(self.normalised(values))
        return torch.cat([network(motion) for network in self.discriminator], dim=1)


_NETWORK: Final = NetworkKind(
    name="s2ue",
    wanted="a Speech2UnifiedExpressions network for the default body's face",
    remedy="Give one that 'motionjury train s2ue' wrote",
)


@dataclass(frozen=True, kw_only=True, eq=False)
class S2ueNetwork(TrainedNetwork[Network]):
    """A network with all that its motion depends on: the content of its file.

    Attributes
    ----------
    vectors : str
        The word vectors that it was trained with.
    """

    speakers: Speakers
    vectors: str


def write_network(path: Path, network: S2ueNetwork) -> None:
    """Write a network to one safetensors file."""
    _NETWORK.write(path, network, "network", vectors=network.vectors)


def load_network(path: Path, face: FaceLandmarks) -> S2ueNetwork:
    """Return the network of a file that `write_network` wrote.

    Raises
    ------
    InputError
        If the file holds another network, or one for other landmarks than those of `face`.
    """
    with _NETWORK.reading(path) as file:
        config = NetworkConfig(**file.facts["config"])
        neutral, expected = file.tensors["network.neutral"], torch.from_numpy(face.neutral)
        if neutral.shape != expected.shape or not torch.allclose(neutral, expected, atol=1e-5):
            raise ValueError("landmarks of another face")
        return S2ueNetwork(
            model=file.loaded(Network(config, face), "network"),
            speakers=Speakers(tuple(file.facts["speakers"]), config.speakers),
            vectors=str(file.facts["vectors"]),
            training=file.facts["training"],
        )
