"""Small untrained networks of Speech2UnifiedExpressions."""

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch

from generators.s2ue.config import NetworkConfig
from generators.s2ue.model import Network, S2ueNetwork, write_network
from motion.body.face_landmarks import FaceLandmarks
from motion.skeleton import JOINT_COUNT, joint_index
from tests.motion.random_clips import clip_of
from training.spaces.bones_and_landmarks import bone_and_landmark_values
from training.speakers import Speakers
from training.speech_features.word_vectors import StandIn

FACE: Final = FaceLandmarks.of_default_body()
SMALL: Final = NetworkConfig(
    speakers=2,
    audio_width=6,
    text_width=5,
    speaker_width=4,
    node_width=3,
    part_width=3,
    face_width=4,
    pose_width=4,
    hidden=8,
    reach=3,
)


def standing() -> np.ndarray:
    """Values of a person whose arms hang, (27 + 3 L,)."""
    poses = np.zeros((1, JOINT_COUNT, 3))
    for side, sign in (("left", -1), ("right", 1)):
        poses[:, joint_index(f"{side}_shoulder"), 2] = 1.2 * sign
    clip = clip_of(poses, frame_rate=15, arkit=np.full((1, 52), 0.02))
    values: np.ndarray = bone_and_landmark_values(clip, FACE)[0].astype(np.float32)
    return values


def small_network(**changes: Any) -> Network:
    """Return a network in evaluation mode that moves a little around a standing person."""
    torch.manual_seed(5)
    network = Network(replace(SMALL, **changes), FACE).eval().requires_grad_(False)
    deviation = torch.full_like(network.deviation, 0.15)
    deviation[27:] = 1e-3
    for name, values in (("mean", standing()), ("rest", standing())):
        network.get_buffer(name).copy_(torch.from_numpy(values))
    network.deviation.copy_(deviation)
    network.sound[1] = 5
    return network


def written_network(path: Path, **changes: Any) -> Path:
    """Write such a network with the speakers anna and ben."""
    network = small_network(**changes)
    speakers = Speakers(("anna", "ben"), network.config.speakers)
    write_network(
        path, S2ueNetwork(model=network, speakers=speakers, vectors=StandIn().description)
    )
    return path
