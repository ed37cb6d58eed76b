"""Sizes of a Speech2UnifiedExpressions network, and its default training.

Bhattacharya et al. 2024. Its code was never released. Values that the paper does not give are those
of the first author's earlier Speech2AffectiveGestures ("S2AG"), or chosen here, as noted for each.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
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
        Length of a word's vector, 300 for FastText.
    sound, bands : int
        Channels of MFCC and of the spectrogram in a frame; the paper gives neither. S2AG has 37
        MFCC, 31 times a second.
    frames, seeds : int
        T and T_s, 34 and 4.
    frame_rate : float
        15 frames per second.
    audio_width, text_width, speaker_width : int
        D_a, D_w and D_k, as in S2AG.
    node_width, part_width : int
        D_f and D_u, of a landmark or a bone; D_l and D_v, of an anatomical component; as in S2AG.
    face_width, pose_width : int
        Widths of the latents of seed face and seed pose; chosen. S2AG has 8 for the pose.
    hidden : int
        Width of encoders' and decoders' inner layers; chosen.
    reach : int
        Kernel size of temporal convolutions on graphs in frames, 9 as in S2AG.
    hops : int
        Largest distance of neighbouring bones: 2, so bones connected by a third one are neighbours.
    faces, poses : bool
        Whether it generates faces, and poses; False is 'w/o Face Synthesis' and 'w/o Pose
        Synthesis'.
    face_graph, pose_graph : bool
        Whether it has the graphs of anatomical components; False is 'w/o Face AC Graph' and 'w/o
        Pose AC Graph'.
    synchronous : bool
        Whether both are generated from one embedding; False, with two networks, is 'w/o Synchronous
        Synthesis'.
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
        """Shape of a speaker's latents: one for each network."""
        return len(self.modalities), self.speaker_width

    def width_of(self, modalities: tuple[str, ...]) -> int:
        """Return the total width of the latents of some modalities."""
        widths = {"face": self.face_width, "pose": self.pose_width}
        return sum(widths[name] for name in modalities)


@dataclass(frozen=True, kw_only=True)
class LossWeights:
    """The weights of the losses; the paper gives no numbers.

    All distances are means over frames and values, divided by the spread of the recordings' values,
    so that faces count as much as poses.

    Attributes
    ----------
    velocity, acceleration : float
        λ_vel and λ_acc of equation 17, which multiply f and u, and their differences. Both zero is
        'w/o Vel.+Acc. Losses'.
    diversity, margin : float
        Weight of the cross-speaker ranking loss (section 5.2.2), and the margin by which the own
        speaker's motion should be nearer to the recording.
    adversarial : float
        Weight of equation 18; S2AG's 5 of 500. Zero is 'w/o Discriminator'.
    latent : float
        Weight of the divergence of the speakers' latents from a standard normal. The paper does not
        mention it, but without it latents could not be sampled; S2AG's 0.1 of 500.
    """

    velocity: float = 1.0
    acceleration: float = 1.0
    diversity: float = 0.05
    margin: float = 0.1
    adversarial: float = 0.01
    latent: float = 2e-4


ABLATIONS: Final[Mapping[str, Mapping[str, Any]]] = {
    "without_face": {"faces": False},
    "without_pose": {"poses": False},
    "without_velocity_acceleration": {"velocity": 0.0, "acceleration": 0.0},
    "without_discriminator": {"adversarial": 0.0},
    "without_face_graph": {"face_graph": False},
    "without_pose_graph": {"pose_graph": False},
    "without_synchrony": {"synchronous": False},
}
"""The seven ablations of Table 1, as changes of `NetworkConfig` or `LossWeights`."""


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
"""Presets by config."""
