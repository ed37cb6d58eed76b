"""Speech2UnifiedExpressions: its rate, and its ablations in a table like the paper's Table 1.

``python -m benchmarks.s2ue speed`` moves a minute of noise to motion by a network of the tiny size,
from samples to clip, with one thread. ``python -m benchmarks.s2ue table CORPUS FOLDER`` trains the
full model and the seven ablations on a synthetic corpus, each for the same steps, and measures them
on windows of test takes whose seeds are recorded.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import mean, median
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from analysis.metrics.absolute_error import MAJE, MALE, absolute_error, box_scale
from analysis.metrics.acceleration_error import MACE_LANDMARKS, MACE_POSES, acceleration_error
from analysis.metrics.frechet import frechet_of_samples
from generators.s2ue.config import ABLATIONS, PRESETS, NetworkConfig
from generators.s2ue.generate import S2ue
from generators.s2ue.model import Network
from generators.s2ue.network_file import S2ueNetwork, load_network, write_network
from generators.s2ue.settings import S2ueSettings
from generators.s2ue.train import train_s2ue
from generators.trainable import TrainingRequest
from motion.face_landmarks import FaceLandmarks
from motion.formats.ted_npz import JOINT_NAMES
from motion.rest_pose import REST_JOINTS
from motion.skeleton import joint_index
from training.data.any_folder import read_takes
from training.data.feature_cache import PreparedTakes, prepare
from training.data.take import TakeFolder
from training.data.windows import Windows
from training.hearing.word_vectors import StandIn
from training.point_features import features_of
from training.spaces.bones_and_landmarks import BONE_LENGTHS, BONE_VALUES, directions_of, joints_of
from training.speakers import Speakers
from training.threads import torch_threads

FloatArray = NDArray[np.float64]

RATE: Final = 15.0
SEEDS: Final = 4
FEATURES: Final = 32
"""Of the autoencoders behind FGD and FLD."""
COLUMNS: Final = ("MALE", "MAJE", "MAcE-LM", "MAcE-P", "FLD", "FGD", "synchrony")


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


def table(corpus: Path, folder: Path, steps: int, seed: int) -> Iterator[str]:
    """Yield the rows of the table, training what `folder` lacks."""
    takes = read_takes(corpus)
    cache = folder / "features"
    face = FaceLandmarks.of_default_body()
    prepared = prepare(
        takes, features_of(takes.kind, face, StandIn(), RATE, faces=True), cache, frame_rate=RATE
    )
    recorded = Windows(prepared, split="test", frames=34, stride=34)
    learned = Windows(prepared, split="train", frames=34, stride=10)
    measure = _Measure(recorded, learned, face)
    yield f"| | {' | '.join(COLUMNS)} |"
    yield f"|---{'|---' * len(COLUMNS)}|"
    yield _row("recorded", measure(measure.recorded, face=True, pose=True))
    for ablation in (*ABLATIONS, None):
        out = folder / f"{ablation or 'full'}_{seed}.safetensors"
        if not out.exists():
            _train(takes, cache, out, ablation, steps, seed)
        network = load_network(out, face)
        values = _moved(network, recorded, prepared)
        config = network.network.config
        yield _row(ablation or "full model", measure(values, face=config.faces, pose=config.poses))


def _train(
    takes: TakeFolder, cache: Path, out: Path, ablation: str | None, steps: int, seed: int
) -> None:
    request = TrainingRequest(
        takes=takes,
        out=out,
        cache=cache,
        config="tiny",
        changes={"steps": steps, "seed": seed, "validate_every": 50},
        choices={} if ablation is None else {"ablation": ablation},
    )
    train_s2ue(request)


def _moved(trained: S2ueNetwork, windows: Windows, prepared: PreparedTakes) -> FloatArray:
    """Return motion of all windows (windows, T, values), from recorded seeds."""
    network, config = trained.network, trained.network.config
    rows = np.arange(len(windows))
    told = {name: torch.from_numpy(one) for name, one in windows.batch(rows).items()}
    people = trained.speakers.one_hot(windows.speakers(rows))
    noise = torch.randn(
        (len(rows), *config.latents),
        generator=torch.Generator().manual_seed(1),
    )
    with torch.inference_mode():
        values, _ = network.synthesise(
            told["sound"],
            told["words"],
            torch.from_numpy(people),
            noise,
            told["motion"][:, : config.seeds],
        )
        values = network.with_lips(values, told["spectrum"])
    return values.numpy().astype(np.float64)


class _Measure:
    """The columns of the table, for windows of motion."""

    def __init__(self, recorded: Windows, learned: Windows, face: FaceLandmarks) -> None:
        self._neutral = face.neutral.astype(np.float64)
        self.recorded = recorded.batch(np.arange(len(recorded)))["motion"].astype(np.float64)
        joints, landmarks = self._points(self.recorded)
        self._scales = box_scale(joints), box_scale(landmarks)
        seen = learned.batch(np.arange(len(learned)))["motion"]
        self._encoders = {
            part: _encoder(seen[:, SEEDS:, values])
            for part, values in (("pose", slice(BONE_VALUES)), ("face", slice(BONE_VALUES, None)))
        }

    def __call__(self, values: FloatArray, *, face: bool, pose: bool) -> Mapping[str, float]:
        """Return the columns; NaN of what is not told."""
        joints, landmarks = (
            list(zip(*pair, strict=True))
            for pair in zip(self._points(values), self._points(self.recorded), strict=True)
        )
        found = dict.fromkeys(COLUMNS, float("nan"))
        if face:
            found["MALE"], found["MAcE-LM"] = (
                mean(
                    error(one, two, frame_rate=RATE, settings=how, scale=self._scales[1]).value
                    for one, two in landmarks
                )
                for error, how in ((absolute_error, MALE), (acceleration_error, MACE_LANDMARKS))
            )
            found["FLD"] = self._distance(values, "face", slice(BONE_VALUES, None))
        if pose:
            found["MAJE"], found["MAcE-P"] = (
                mean(
                    error(one, two, frame_rate=RATE, settings=how, scale=self._scales[0]).value
                    for one, two in joints
                )
                for error, how in ((absolute_error, MAJE), (acceleration_error, MACE_POSES))
            )
            found["FGD"] = self._distance(values, "pose", slice(BONE_VALUES))
        if face and pose:
            found["synchrony"] = _synchrony(
                [one for one, _ in joints], [one for one, _ in landmarks]
            )
        return found

    def _points(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return joints and landmarks, (windows, T, points, 3)."""
        count, frames, _ = values.shape
        directions = values[..., :BONE_VALUES].reshape(count * frames, -1, 3)
        joints = joints_of(directions, BONE_LENGTHS)
        shifts = values[..., BONE_VALUES:].reshape(count, frames, -1, 3)
        return joints.reshape(count, frames, -1, 3), self._neutral + shifts

    def _distance(self, values: FloatArray, part: str, of: slice) -> float:
        encode = self._encoders[part]
        with torch.inference_mode():
            one, two = (
                encode(torch.from_numpy(motion[:, SEEDS:, of]).float()).double().numpy()
                for motion in (values, self.recorded)
            )
        return frechet_of_samples(one, two)


def _encoder(seen: NDArray[np.float32]) -> nn.Module:
    """Return the encoder of an autoencoder that rebuilds windows of motion."""
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
    """Values of mean 0 and deviation 1, flat."""

    def __init__(self, mean_: torch.Tensor, spread: torch.Tensor) -> None:
        super().__init__()
        self._mean, self._spread = mean_, spread

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        """Return (windows, frames · values)."""
        normal: torch.Tensor = ((values - self._mean) / self._spread).flatten(1)
        return normal


def _synchrony(joints: list[FloatArray], landmarks: list[FloatArray]) -> float:
    """Return the mean correlation of how fast face and body move, window by window."""
    found = []
    for body, face in zip(joints, landmarks, strict=True):
        speeds = [
            np.linalg.norm(np.diff(points[SEEDS:], axis=0), axis=2).mean(axis=1)
            for points in (body, face)
        ]
        if all(one.std() > 0 for one in speeds):
            found.append(float(np.corrcoef(*speeds)[0, 1]))
    return mean(found)


def _row(name: str, found: Mapping[str, float]) -> str:
    cells = ("–" if np.isnan(found[one]) else f"{found[one]:.3g}" for one in COLUMNS)
    return f"| {name.replace('_', ' ')} | {' | '.join(cells)} |"


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(dest="what", required=True)
    fast = kinds.add_parser("speed")
    fast.add_argument("--rounds", type=int, default=5)
    tables = kinds.add_parser("table")
    tables.add_argument("corpus", type=Path)
    tables.add_argument("folder", type=Path)
    tables.add_argument("--steps", type=int, default=150)
    tables.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    if given.what == "speed":
        speed(given.rounds)
        return
    with torch_threads(1):
        for line in table(given.corpus, given.folder, given.steps, given.seed):
            print(line, flush=True)


if __name__ == "__main__":
    main()
