"""The columns of the table, acceleration at the seams of windows, and frames per second."""

import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import mean, median
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from analysis.metrics.frechet import frechet_of_samples
from analysis.metrics.point_errors import (
    MACE_LANDMARKS,
    MACE_POSES,
    MAJE,
    MALE,
    box_scale,
    point_error,
)
from analysis.metrics.scores import MetricResult
from benchmarks.s2ue.synchrony import FaceBodySynchrony
from benchmarks.seams import seams_of_clip
from generators.interface import SpeechSegment
from generators.learned_settings import S2ueSettings
from generators.s2ue.config import PRESETS, NetworkConfig
from generators.s2ue.generate import S2ue
from generators.s2ue.model import Network, S2ueNetwork, write_network
from motion.audio import SPEECH_RATE, Audio, read_audio
from motion.body.face_landmarks import FaceLandmarks
from motion.formats.ted_npz import JOINT_NAMES
from motion.segment import Segment
from motion.skeleton import REST_JOINTS, joint_index
from training.data.windows import Windows
from training.device import torch_threads
from training.spaces.bones_and_landmarks import (
    BONE_LENGTHS,
    BONE_VALUES,
    bone_directions,
    joints_from_directions,
)
from training.speakers import Speakers
from training.speech_features.word_vectors import StandIn

FloatArray = NDArray[np.float64]

RATE: Final = 15.0
SEEDS: Final = 4
FEATURES: Final = 32
"""Features of the autoencoders behind FGD and FLD."""
VALUES: Final = {"pose": slice(BONE_VALUES), "face": slice(BONE_VALUES, None)}
"""Slice of each part in the values of motion."""

PARTS: Final = (
    ("pose", "FGD", (("MAJE", MAJE), ("MAcE-P", MACE_POSES))),
    ("face", "FLD", (("MALE", MALE), ("MAcE-LM", MACE_LANDMARKS))),
)
"""Each part's distance and errors, by their columns."""

COLUMNS: Final = ("MALE", "MAJE", "MAcE-LM", "MAcE-P", "FLD", "FGD", "synchrony")

_RATE: Final = 15.0


class Measure:
    """Computes the columns of the table for windows of motion."""

    def __init__(self, recorded: Windows, learned: Windows, face: FaceLandmarks) -> None:
        self._neutral = face.neutral.astype(np.float64)
        self.recorded = recorded.batch(np.arange(len(recorded)))["motion"].astype(np.float64)
        joints, landmarks = self._points(self.recorded)
        self._scales = box_scale(joints), box_scale(landmarks)
        seen = learned.batch(np.arange(len(learned)))["motion"]
        self.synchrony = FaceBodySynchrony.of(seen[:, SEEDS:].astype(np.float64))
        self._encoders = {
            part: _encoder(seen[:, SEEDS:, values]) for part, values in VALUES.items()
        }

    def __call__(self, values: FloatArray, *, face: bool, pose: bool) -> Mapping[str, float]:
        """Return the columns; NaN for a part that the network does not generate."""
        row_values = dict.fromkeys(COLUMNS, float("nan"))
        generated, recorded = self._points(values), self._points(self.recorded)
        for number, (part, distance, errors) in enumerate(PARTS):
            if (pose, face)[number]:
                for column, settings in errors:
                    row_values[column] = mean(
                        point_error(
                            *pair, frame_rate=RATE, settings=settings, scale=self._scales[number]
                        ).value
                        for pair in zip(generated[number], recorded[number], strict=True)
                    )
                row_values[distance] = self._distance(values, part)
        if face and pose:
            row_values["synchrony"] = self.synchrony(values[:, SEEDS:])
        return row_values

    def _points(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return joints and landmarks, (windows, T, points, 3)."""
        count, frames, _ = values.shape
        directions = values[..., :BONE_VALUES].reshape(count * frames, -1, 3)
        joints = joints_from_directions(directions, BONE_LENGTHS)
        shifts = values[..., BONE_VALUES:].reshape(count, frames, -1, 3)
        return joints.reshape(count, frames, -1, 3), self._neutral + shifts

    def _distance(self, values: FloatArray, part: str) -> float:
        encode, of = self._encoders[part], VALUES[part]
        with torch.inference_mode():
            one, two = (
                encode(torch.from_numpy(motion[:, SEEDS:, of]).float()).double().numpy()
                for motion in (values, self.recorded)
            )
        return frechet_of_samples(one, two)


def _encoder(seen: NDArray[np.float32]) -> nn.Module:
    """Return the encoder of an autoencoder for windows of motion."""
    torch.manual_seed(1)
    values = torch.from_numpy(seen)
    spread = values.std(dim=(0, 1)).clamp(min=1e-5)
    width = values[0].numel()
    normal = _Normal(values.mean(dim=(0, 1)), spread)
    encoder = nn.Sequential(normal, nn.Linear(width, 128), nn.ELU(), nn.Linear(128, FEATURES))
    decoder = nn.Sequential(nn.Linear(FEATURES, 128), nn.ELU(), nn.Linear(128, width))
    optimizer = torch.optim.Adam([*encoder.parameters(), *decoder.parameters()], 1e-3)
    for _ in range(400):
        rows = torch.randint(0, len(values), (128,))
        missed = decoder(encoder(values[rows])) - normal(values[rows])
        optimizer.zero_grad()
        missed.square().mean().backward()
        optimizer.step()
    return encoder.eval()


class _Normal(nn.Module):
    """Values of mean 0 and standard deviation 1, flattened."""

    def __init__(self, mean_: torch.Tensor, spread: torch.Tensor) -> None:
        super().__init__()
        self._mean, self._spread = mean_, spread

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        """Return (windows, frames · values)."""
        normal: torch.Tensor = ((values - self._mean) / self._spread).flatten(1)
        return normal


def seams(checkpoint: Path, speech: Sequence[Path]) -> Iterator[MetricResult]:
    """Yield `seams_of_clip` of the motion for speech files, joined in order."""
    audio = Audio(np.concatenate([read_audio(path).samples for path in speech]), SPEECH_RATE)
    segment = Segment(
        name="all", wav="all.wav", start=0, end=audio.duration, speaker="all", emotion="neutral"
    )
    generator = S2ue(S2ueSettings(checkpoint=checkpoint))
    spoken = SpeechSegment(segment=segment, audio=audio)
    yield from seams_of_clip(generator.generate(spoken, seed=1, frame_rate=_RATE))


def speed(rounds: int) -> None:
    """Print the frames per second of the tiny network on one thread."""
    face = FaceLandmarks.of_default_body()
    torch.manual_seed(1)
    network = Network(NetworkConfig(speakers=4, **PRESETS["tiny"].sizes), face)
    standing = np.zeros(BONE_VALUES + 3 * face.count, np.float32)
    rest = REST_JOINTS[[joint_index(name) for name in JOINT_NAMES]][None]
    standing[:BONE_VALUES] = bone_directions(rest).ravel()
    network.mean.copy_(torch.from_numpy(standing))
    network.rest.copy_(network.mean)
    network.deviation.fill_(1e-3)
    sound = np.random.default_rng(1).normal(0, 0.1, 60 * 16_000).astype(np.float32)
    with TemporaryDirectory() as folder, torch_threads(1):
        path = Path(folder) / "random.safetensors"
        speakers = Speakers(tuple("abcd"), 4)
        write_network(
            path, S2ueNetwork(model=network, speakers=speakers, vectors=StandIn().description)
        )
        generator = S2ue(S2ueSettings(checkpoint=path))
        turns = []
        for _ in range(rounds + 1):
            wall, processors = time.perf_counter(), time.process_time()
            values = np.concatenate(list(generator.stream([sound], seed=1)))
            sampling = time.perf_counter() - wall
            generator.clip_of(values)
            turns.append((sampling, time.perf_counter() - wall, time.process_time() - processors))
    for name, seconds in zip(
        ("motion, by the clock", "clip, by the clock", "clip, of processors"),
        zip(*turns[1:], strict=True),
        strict=True,
    ):
        print(f"{name}: {len(values) / median(seconds):.0f} frames/s")
