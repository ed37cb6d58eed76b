"""Training DiffSHEG on recordings."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor

from generators.diffsheg.config import ABLATIONS, PRESETS, STRIDE, DenoiserConfig, TrainingPreset
from generators.diffsheg.losses import LOSSES, LossWeights, motion_losses
from generators.diffsheg.model import Denoiser
from generators.diffsheg.network_file import MotionNetwork, Normalisation, write_network
from generators.learned import cut_windows, describe_training, run_training
from generators.registry import TrainedGenerator, TrainingRequest
from motion.arrays import Floats, Floats32, Ints
from motion.errors import InputError
from training.data.feature_cache import PreparedTakes
from training.data.take import Feature
from training.data.windows import Windows
from training.diffusion import LINEAR
from training.features import (
    beat_expression,
    beat_gesture,
    hubert_features,
    mel,
    semantic_scores,
    show_expression,
    show_gesture,
)
from training.run.batches import evenly_spaced
from training.run.task import WindowTask
from training.speakers import Speakers
from training.speech_features.hubert import Hubert, load_hubert, stand_in

VALIDATION_WINDOWS: Final = 1024
"""Number of windows for validation; if there are fewer held-out windows, each is used several times
with different noise."""

METRIC: Final = "noise_and_reconstruction"
"""The measure of held-out windows that selects the best weights."""

_VALIDATION_BATCH: Final = 64
"""Held-out windows per batch."""

_MOST_COVARIANCE_WINDOWS: Final = 5_000
"""Largest number of windows for estimating the motion's covariance."""

_VALIDATION_SEED: Final = 24
"""Seed of the noise in held-out windows, the same for every validation."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DiffShegTask(WindowTask):
    """Learning to predict the noise in windows of motion, given the speech.

    Attributes
    ----------
    config : DenoiserConfig
        The network.
    weights : LossWeights
        Weights of the losses.
    training, held_out : Windows
        Windows of the features ``gesture``, ``expression``, ``mel``, ``hubert`` and, for BEAT,
        ``semantic``.
    normalisation : Normalisation
        The normalisation of the takes in `training`.
    speakers : Speakers
        The speakers of the training data.
    """

    config: DenoiserConfig
    weights: LossWeights
    normalisation: Normalisation
    speakers: Speakers

    def network(self) -> Denoiser:
        """Return an untrained network, with the motion's covariance if it has a skip."""
        network = Denoiser(self.config)
        if self.config.skip:
            network.fit_skips(self._covariance_windows)
        return network.to(self.device)

    def losses(self, network: Denoiser, rows: Ints, name: str = "") -> Mapping[str, Tensor]:
        """Return `motion_losses` of a batch with random steps and noise."""
        batch = self._batch(self.training, rows)
        steps = torch.randint(0, LINEAR.steps, (len(rows),)).to(self.device)
        noise = torch.randn(batch["motion"].shape).to(self.device)
        return self._losses(network, batch, steps, noise)

    def validation(self, network: Denoiser) -> Mapping[str, float]:
        """Return `motion_losses` of held-out windows, with the same windows, noise and steps.

        Weights are chosen by the loss without its velocity part, which is smallest for a network
        that hardly moves. Windows and diffusion steps are evenly spaced. A guided network is
        measured without guidance.
        """
        rows = np.linspace(0, len(self.held_out) - 1, VALIDATION_WINDOWS).round().astype(np.int64)
        chance = np.random.default_rng(_VALIDATION_SEED)
        steps = chance.permutation(LINEAR.steps * (2 * np.arange(len(rows)) + 1) // (2 * len(rows)))
        _set_guidance(network, None)
        sums: defaultdict[str, float] = defaultdict(float)
        for first in range(0, len(rows), _VALIDATION_BATCH):
            part = slice(first, first + _VALIDATION_BATCH)
            batch = self._batch(self.held_out, rows[part])
            noise = chance.standard_normal(tuple(batch["motion"].shape), dtype=np.float32)
            given = (torch.from_numpy(each).to(self.device) for each in (steps[part], noise))
            for name, value in self._losses(network, batch, *given).items():
                sums[name] += float(value) * len(noise)
        _set_guidance(network, self.config.guidance)
        means = {name: total / len(rows) for name, total in sums.items()}
        return {METRIC: means["loss"] - self.weights.velocity * means["velocity"], **means}

    @cached_property
    def _covariance_windows(self) -> Floats32:
        """Normalised motion of evenly spaced training windows."""
        rows = evenly_spaced(len(self.training), _MOST_COVARIANCE_WINDOWS)
        return self._normalised_motion(dict(self.training.batch(rows)))

    def _losses(
        self, network: Denoiser, batch: Mapping[str, Tensor], steps: Tensor, noise: Tensor
    ) -> dict[str, Tensor]:
        noisy = LINEAR.x_t(batch["motion"], noise, steps)
        eps: Tensor = network(noisy, steps, *(batch[name] for name in ("mel", "hubert", "person")))
        return motion_losses(noise, eps, steps, self.weights, batch.get("semantic"))

    def _batch(self, windows: Windows, rows: Ints) -> Mapping[str, Tensor]:
        """Return windows by feature, with normalised ``motion`` and one-hot ``person``."""
        values = dict(windows.batch(rows))
        values["motion"] = self._normalised_motion(values)
        values["person"] = self.speakers.one_hot(windows.speakers(rows))
        return {name: torch.from_numpy(array).to(self.device) for name, array in values.items()}

    def _normalised_motion(self, values: dict[str, Floats32]) -> Floats32:
        """Return normalised motion, and remove its two features from `values`."""
        motion = np.concatenate([values.pop(name) for name in ("gesture", "expression")], axis=-1)
        return self.normalisation.normalised(motion.astype(np.float64)).astype(np.float32)


def _set_guidance(network: Denoiser, guidance: float | None) -> None:
    for branch in network.ordered_branches.values():
        branch.guidance = guidance


_DATASETS: Final[Mapping[str, str]] = {"beat": "beat", "beat2": "show", "show": "show"}
"""The data set whose representation is used for recordings of a layout."""


def training_features(dataset: str, hubert: Hubert, frame_rate: float) -> tuple[Feature, ...]:
    """Return the features that DiffSHEG is trained on.

    Parameters
    ----------
    dataset : {'beat', 'show'}
        The data set whose motion representation the network has; ``show`` also for BEAT2.
    hubert : Hubert
        The speech network.
    frame_rate : float
        Frames per second of all features.

    Returns
    -------
    tuple of Feature
        ``gesture``, ``expression``, ``mel``, ``hubert``; for BEAT also ``semantic``.
    """
    speech = (mel(frame_rate), hubert_features(frame_rate, hubert))
    if dataset == "beat":
        scores = semantic_scores(frame_rate)
        return (beat_gesture(frame_rate), beat_expression(frame_rate), *speech, scores)
    return (show_gesture(frame_rate), show_expression(frame_rate), *speech)


def train_diffsheg(request: TrainingRequest) -> TrainedGenerator:
    """Train DiffSHEG; see `generators.registry.TrainGenerator`."""
    dataset, preset = _requested_preset(request)
    folder = request.choices.get("hubert")
    hubert = (stand_in() if folder is None else load_hubert(Path(folder))).to_device(request.device)
    frame_rate = preset.network.frame_rate
    features = training_features(dataset, hubert, frame_rate)
    windows = cut_windows(request, features, frame_rate, preset.network.frames, STRIDE)
    prepared = windows["training"].prepared
    names = prepared.training_speakers(request.takes.speakers)
    sizes = replace(preset.network, speakers=max(len(names), preset.network.speakers))
    task = DiffShegTask(
        config=sizes,
        weights=LOSSES[preset.losses],
        normalisation=normalisation_of(prepared),
        speakers=Speakers(names, sizes.speakers),
        extra_settings={
            "hubert": hubert.identity,
            "speakers": list(names),
            "weights chosen by": f"{METRIC} of {VALIDATION_WINDOWS} windows",
        },
        **windows,
    )
    config = preset.config_for(task.examples, request.changes)
    trained, facts = run_training(request, task, config)
    network = MotionNetwork(
        model=trained.network.cpu(),
        dataset=dataset,
        normalisation=task.normalisation,
        speakers=task.speakers,
        hubert=hubert.identity,
        training={**facts, "losses": preset.losses},
    )
    write_network(request.out, network)
    measured = trained.best.measured
    return describe_training(
        task,
        trained,
        f"Held-out loss: noise and reconstruction {measured[METRIC]:.4g}, which selects the "
        f"weights; with velocity {measured['loss']:.4g}.",
        warnings=[
            f"Speech was encoded by a {hubert.description}: the network can learn the timing and "
            "manner of speech, but not its words."
        ]
        if hubert.stands_in
        else [],
    )


def _requested_preset(request: TrainingRequest) -> tuple[str, TrainingPreset]:
    """Return the data set whose representation is used, and the researcher's choices."""
    kind = request.takes.kind
    dataset = _DATASETS.get(kind, "")
    preset = PRESETS[request.config].get(dataset)
    if preset is None:
        raise InputError(
            f"the config {request.config} does not fit recordings of the layout {kind!r}",
            remedy="Give recordings with faces: of BEAT for --config beat, of BEAT2 or SHOW for "
            "show, any of them for tiny",
        )
    ablation = request.choices.get("ablation")
    changes = {} if ablation is None else ABLATIONS[ablation]
    losses = request.choices.get("preset", preset.losses)
    return dataset, replace(preset, network=replace(preset.network, **changes), losses=losses)


def normalisation_of(prepared: PreparedTakes) -> Normalisation:
    """Return mean and standard deviation of each value over all frames of the training takes."""

    def motions() -> Iterator[Floats]:
        for number, take in enumerate(prepared.takes):
            if take.split == "train":
                parts = [prepared.arrays[name][number] for name in ("gesture", "expression")]
                yield np.concatenate(parts, axis=1, dtype=np.float64)

    count = sum(len(motion) for motion in motions())
    mean = np.sum([motion.sum(axis=0) for motion in motions()], axis=0) / count
    squares = np.sum([((motion - mean) ** 2).sum(axis=0) for motion in motions()], axis=0)
    return Normalisation(mean, np.sqrt(squares / count))
