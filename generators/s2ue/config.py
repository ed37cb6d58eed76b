"""Sizes of a Speech2UnifiedExpressions network, and its default training.

Bhattacharya et al. 2024. Its code was never released; where the paper is silent, values are those
of the first author's earlier Speech2AffectiveGestures ("S2AG"), or chosen here. Each says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from training.config import Preset, read_presets


@dataclass(frozen=True, kw_only=True)
class NetworkConfig:
    """Sizes of the networks, and the ablations of the paper's Table 1 as switches.

    Attributes
    ----------
    speakers : int
        Length of the one-hot vector, the paper's K.
    words : int
        Length of a word's vector, 300 of FastText.
    sound, bands : int
        Channels of MFCC and of the spectrogram in a frame; the paper tells neither. S2AG has 37
        MFCC, 31 times a second.
    frames, seeds : int
        T and T_s, 34 and 4.
    frame_rate : float
        15 frames per second.
    audio_width, text_width, speaker_width : int
        D_a, D_w and D_k; as S2AG's.
    node_width, part_width : int
        D_f and D_u, of a landmark or a bone; D_l and D_v, of an anatomical component; as S2AG's.
    face_width, pose_width : int
        Widths of the latents of seed face and seed pose; chosen. S2AG has 8 for the pose.
    hidden : int
        Width of encoders' and decoders' inner layers; chosen.
    reach : int
        Frames of temporal convolutions on graphs, 9 as S2AG's.
    hops : int
        Bones that are connected, or connected through a third one, are neighbours: 2.
    faces, poses : bool
        Whether it generates faces, and poses; without one of them is 'w/o Face Synthesis' and
        'w/o Pose Synthesis'.
    face_graph, pose_graph : bool
        Whether it has the higher graphs of components; without is 'w/o Face AC Graph' and
        'w/o Pose AC Graph'.
    synchronous : bool
        Whether both are generated from one embedding; two networks are 'w/o Synchronous Synthesis'.
    """

    speakers: int
    words: int = 300
    sound: int = 84
    bands: int = 128
    frames: int = 34
    seeds: int = 4
    frame_rate: float = 15.0
    audio_width: int = 32
    text_width: int = 32
    speaker_width: int = 16
    node_width: int = 16
    part_width: int = 16
    face_width: int = 16
    pose_width: int = 16
    hidden: int = 64
    reach: int = 9
    hops: int = 2
    faces: bool = True
    poses: bool = True
    face_graph: bool = True
    pose_graph: bool = True
    synchronous: bool = True

    @property
    def modalities(self) -> tuple[tuple[str, ...], ...]:
        """The modalities of each network."""
        names = tuple(name for name, used in (("face", self.faces), ("pose", self.poses)) if used)
        return (names,) if self.synchronous else tuple((name,) for name in names)

    @property
    def latents(self) -> tuple[int, int]:
        """Shape of what is drawn of a speaker: for each network one latent."""
        return len(self.modalities), self.speaker_width

    def width_of(self, modalities: tuple[str, ...]) -> int:
        """Return the total width of the latents of some modalities."""
        widths = {"face": self.face_width, "pose": self.pose_width}
        return sum(widths[name] for name in modalities)


@dataclass(frozen=True, kw_only=True)
class LossWeights:
    """The weights of the losses; the paper gives no numbers.

    All distances are means over frames and values, in units of how far the recordings' values
    spread, so that faces count as much as poses do.

    Attributes
    ----------
    velocity, acceleration : float
        λ_vel and λ_acc of equation 17, which multiply f and u, and their differences. Zero both is
        'w/o Vel.+Acc. Losses'.
    diversity, margin : float
        Of the cross-speaker ranking loss (section 5.2.2); by how much nearer the own speaker's
        motion is to lie.
    adversarial : float
        Weight of equation 18; S2AG's 5 of 500. Zero is 'w/o Discriminator'.
    latent : float
        Of the divergence of the speakers' latent from a normal one, which the paper does not name
        and without which it could not be sampled; S2AG's 0.1 of 500.
    """

    velocity: float = 1.0
    acceleration: float = 1.0
    diversity: float = 0.05
    margin: float = 0.1
    adversarial: float = 0.01
    latent: float = 2e-4


ABLATIONS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "without_face": {"faces": False},
        "without_pose": {"poses": False},
        "without_velocity_acceleration": {"velocity": 0.0, "acceleration": 0.0},
        "without_discriminator": {"adversarial": 0.0},
        "without_face_graph": {"face_graph": False},
        "without_pose_graph": {"pose_graph": False},
        "without_synchrony": {"synchronous": False},
    }
)
"""The seven of Table 1, each by what differs of `NetworkConfig` or `LossWeights`."""


@dataclass(frozen=True, kw_only=True)
class S2uePreset(Preset):
    """Sizes and training.

    Attributes
    ----------
    sizes : mapping
        Differences from `NetworkConfig`.
    """

    sizes: Mapping[str, Any]


PRESETS: Final = read_presets(Path(__file__).with_name("presets.toml"), S2uePreset)
"""By config."""
