"""How many frames a second Speech2UnifiedExpressions makes."""

from __future__ import annotations

import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np
import torch

from generators.s2ue.config import PRESETS, NetworkConfig
from generators.s2ue.generate import S2ue
from generators.s2ue.model import Network
from generators.s2ue.network_file import S2ueNetwork, write_network
from generators.s2ue.settings import S2ueSettings
from motion.body.face_landmarks import FaceLandmarks
from motion.formats.ted_npz import JOINT_NAMES
from motion.rest_pose import REST_JOINTS
from motion.skeleton import joint_index
from training.hearing.word_vectors import StandIn
from training.spaces.bones_and_landmarks import BONE_VALUES, directions_of
from training.speakers import Speakers
from training.threads import torch_threads


def speed(rounds: int) -> None:
    """Print how many frames a second the tiny network makes on one thread."""
    face = FaceLandmarks.of_default_body()
    torch.manual_seed(1)
    network = Network(NetworkConfig(speakers=4, **PRESETS["tiny"].sizes), face)
    standing = np.zeros(BONE_VALUES + 3 * face.count, np.float32)
    rest = REST_JOINTS[[joint_index(name) for name in JOINT_NAMES]][None]
    standing[:BONE_VALUES] = directions_of(rest).ravel()
    network.mean.copy_(torch.from_numpy(standing))
    network.rest.copy_(network.mean)
    network.deviation.fill_(1e-3)
    sound = np.random.default_rng(1).normal(0, 0.1, 60 * 16_000).astype(np.float32)
    with TemporaryDirectory() as folder, torch_threads(1):
        path = Path(folder) / "random.safetensors"
        speakers = Speakers(tuple("abcd"), 4)
        write_network(
            path, S2ueNetwork(network=network, speakers=speakers, vectors=StandIn().description)
        )
        made = S2ue(S2ueSettings(checkpoint=path))
        turns = []
        for _ in range(rounds + 1):
            wall, processors = time.perf_counter(), time.process_time()
            values = np.concatenate(list(made.stream([sound], seed=1)))
            told = time.perf_counter() - wall
            made.clip_of(values)
            turns.append((told, time.perf_counter() - wall, time.process_time() - processors))
    for name, seconds in zip(
        ("motion, by the clock", "clip, by the clock", "clip, of processors"),
        zip(*turns[1:], strict=True),
        strict=True,
    ):
        print(f"{name}: {len(values) / median(seconds):.0f} frames/s")
