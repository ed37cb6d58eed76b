"""Training Speech2UnifiedExpressions on recordings."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any, Final, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from generators.learned import cut_windows, describe_training, run_training
from generators.registry import TrainedGenerator, TrainingRequest
from generators.s2ue.config import ABLATIONS, PRESETS, LossWeights, NetworkConfig
from generators.s2ue.losses import (
    discriminator_loss,
    diversity_loss,
    generator_loss,
    phoneme_loss,
    reconstruction_losses,
)
from generators.s2ue.model import Latents, Network, S2ueNetwork, write_network
from motion.arrays import Floats, Ints
from motion.body.face_landmarks import FaceLandmarks
from training.data.windows import Windows
from training.features import bone_features
from training.run.batches import evenly_spaced
from training.run.task import WindowTask
from training.spaces.bones_and_landmarks import BONE_VALUES, joints_from_directions, split_motion
from training.speakers import Speakers, latent_loss
from training.speech_features.word_vectors import StandIn, load_word_vectors

STRIDE: Final = 10
"""Frames from one training window to the next, as in the TED Gesture data set."""

MOST_HELD_OUT: Final = 256
"""Largest number of windows for validation."""

_MOST_STATISTICS_WINDOWS: Final = 4_000
"""Largest number of windows for estimating the spread of values."""

_SMALLEST_DEVIATION: Final = 1e-5
"""Smallest standard deviation of values, used for constant ones."""

_Settings = TypeVar("_Settings", NetworkConfig, LossWeights)
_Batch = Mapping[str, Tensor]
"""Windows of ``motion``, ``sound``, ``spectrum`` and ``words``, and one-hot ``person``."""


@dataclass(frozen=True, kw_only=True, eq=False)
class S2ueTask(WindowTask):
    """Learning to continue a speaker's motion to their speech.

    Attributes
    ----------
    config : NetworkConfig
        The networks.
    weights : LossWeights
        Weights of the losses.
    training, held_out : Windows
        Windows of the features ``motion``, ``sound``, ``spectrum`` and ``words``.
    face : FaceLandmarks
        The landmarks of the motion.
    speakers : Speakers
        The speakers of the training data.
    """

    config: NetworkConfig
    weights: LossWeights
    face: FaceLandmarks
    speakers: Speakers

    def network(self) -> Network:
        """Return new networks with the statistics of the recordings."""
        network = Network(self.config, self.face)
        for name, v in self._statistics.items():
            network.get_buffer(name).copy_(torch.from_numpy(v.astype(np.float32)))
        return network.to(self.device)

    def losses(self, network: Network, rows: Ints, name: str) -> Mapping[str, Tensor]:
        """Return the losses of discriminator, phoneme predictor or, by default, generator."""
        batch, weights = self._batch(self.training, rows), self.weights
        if name == "phonemes":
            return {"loss": self._phonemes(network, batch)}
        noise = torch.randn(len(rows), *self.config.latents).to(self.device)
        if name == "discriminator":
            with torch.no_grad():
                motion, _ = self._synthesise(network, batch, noise)
            recorded_logits = network.discriminate(batch["motion"])
            return {"loss": discriminator_loss(recorded_logits, network.discriminate(motion))}
        motion, latents = self._synthesise(network, batch, noise)
        parts = reconstruction_losses(network, motion, batch["motion"], weights)
        if weights.latent:
            parts["latent"] = latent_loss(latents)
        if weights.diversity and len(self.speakers.names) > 1:
            other_batch = {**batch, "person": self._other_speakers(batch["person"])}
            other_motion, _ = self._synthesise(network, other_batch, noise)
            parts["diversity"] = diversity_loss(
                network, motion, other_motion, batch["motion"], weights.margin
            )
        if weights.adversarial:
            parts["adversarial"] = generator_loss(network.discriminate(motion))
        weighted = [
            getattr(weights, part) * parts[part]
            for part in ("latent", "diversity", "adversarial")
            if part in parts
        ]
        return {"loss": sum(weighted, start=parts["reconstruction"]), **parts}

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return equations 17 and 16 of held-out windows, with the mean of each speaker's latent.

        All of equation 17 counts, even losses that are not trained, so that ablations are
        comparable.
        """
        rows = evenly_spaced(len(self.held_out), MOST_HELD_OUT)
        batch = self._batch(self.held_out, rows)
        noise = batch["motion"].new_zeros(len(rows), *self.config.latents)
        motion, _ = self._synthesise(network, batch, noise)
        measured = reconstruction_losses(network, motion, batch["motion"], LossWeights())
        if self.config.faces:
            measured["phonemes"] = self._phonemes(network, batch)
            measured = {"missed": measured["reconstruction"] + measured["phonemes"], **measured}
        return {name: float(value) for name, value in measured.items()}

    def _synthesise(self, network: Network, batch: _Batch, noise: Tensor) -> tuple[Tensor, Latents]:
        seeds = batch["motion"][:, : self.config.seeds]
        return network.synthesise(batch["sound"], batch["words"], batch["person"], noise, seeds)

    def _phonemes(self, network: Network, batch: _Batch) -> Tensor:
        target = split_motion(batch["motion"])["face"][:, :, network.lips]
        return phoneme_loss(network.predict_lips(batch["spectrum"]), target, network.spread[0])

    def _other_speakers(self, person: Tensor) -> Tensor:
        """Return one-hot vectors of speakers other than `person`."""
        count = len(self.speakers.names)
        offsets = torch.randint(1, count, (len(person),)).to(self.device)
        other_speakers = (person.argmax(dim=1) + offsets) % count
        return torch.eye(self.config.speakers, device=person.device)[other_speakers]

    def _batch(self, windows: Windows, rows: Ints) -> _Batch:
        people = torch.from_numpy(self.speakers.one_hot(windows.speakers(rows)))
        return {**self.tensors(windows, rows), "person": people.to(self.device)}

    @cached_property
    def _statistics(self) -> Mapping[str, NDArray[np.floating[Any]]]:
        """The buffers of a network: means and standard deviations over evenly spaced windows."""
        windows = self.training.batch(evenly_spaced(self.examples, _MOST_STATISTICS_WINDOWS))
        flat = {name: v.reshape(-1, v.shape[-1]).astype(float) for name, v in windows.items()}
        pose, face = np.split(flat["motion"], [BONE_VALUES], axis=1)
        joints = joints_from_directions(pose.reshape(len(pose), -1, 3)).reshape(len(pose), -1)
        mean, deviation = _mean_and_deviation(flat["motion"])
        return {
            "mean": mean,
            "deviation": deviation,
            "spread": np.array([_spread(v) for v in (face, pose, joints)]),
            "rest": self.training.prepared.mean_first("motion"),
            **{name: np.stack(_mean_and_deviation(flat[name])) for name in ("sound", "spectrum")},
        }


def _mean_and_deviation(values: Floats) -> tuple[Floats, Floats]:
    """Return the mean and standard deviation of each column of values (N, values)."""
    return values.mean(axis=0), np.maximum(values.std(axis=0), _SMALLEST_DEVIATION)


def _spread(values: Floats) -> float:
    """Return the root mean square deviation of values (N, values) from their means."""
    return float(np.maximum(np.sqrt(values.var(axis=0).mean()), _SMALLEST_DEVIATION))


def train_s2ue(request: TrainingRequest) -> TrainedGenerator:
    """Train Speech2UnifiedExpressions; see `generators.registry.TrainGenerator`."""
    preset, kind = PRESETS[request.config], request.takes.kind
    ablation = request.choices.get("ablation")
    changes = {} if ablation is None else ABLATIONS[ablation]
    vectors = load_word_vectors(request.choices.get("vectors"))
    face = FaceLandmarks.of_default_body()
    sizes = NetworkConfig(speakers=1, words=vectors.width, **preset.sizes)
    config, weights = _with_changes(sizes, changes), _with_changes(LossWeights(), changes)
    features = bone_features(kind, face, vectors, config.frame_rate, faces=config.faces)
    windows = cut_windows(request, features, config.frame_rate, config.frames, STRIDE)
    names = windows["training"].prepared.training_speakers(request.takes.speakers)
    task = S2ueTask(
        config=replace(config, speakers=len(names)),
        weights=weights,
        face=face,
        speakers=Speakers(names, len(names)),
        extra_settings={"speakers": list(names), "vectors": vectors.description},
        **windows,
    )
    training = preset.config_for(task.examples, request.changes)
    used = {"generator": True, "discriminator": weights.adversarial, "phonemes": config.faces}
    passes = tuple(update_pass for update_pass in training.passes if used[update_pass.name])
    trained, facts = run_training(request, task, replace(training, passes=passes))
    network = S2ueNetwork(
        model=trained.network.cpu(),
        speakers=task.speakers,
        vectors=vectors.description,
        training={**facts, "losses": asdict(weights)},
    )
    write_network(request.out, network)
    takes = [take for take in task.training.prepared.takes if take.split == "train"]
    transcribed = sum(take.transcript is not None for take in takes)
    warnings = []
    if isinstance(vectors, StandIn):
        warnings.append(
            f"Words were encoded by a {vectors.description}; give FastText's with --vectors."
        )
    if not transcribed:
        warnings.append("It learned from sound alone: no recording has a transcript.")
    return describe_training(
        task,
        trained,
        f"Takes with a transcript: {transcribed}.",
        f"Loss of reconstruction (equation 17) in {len(task.held_out)} held-out windows: "
        f"{trained.best.measured['reconstruction']:.3f}, in units of the motion's spread.",
        warnings=warnings,
    )


def _with_changes(settings: _Settings, changes: Mapping[str, Any]) -> _Settings:
    """Return settings with those changes of an ablation that apply to them."""
    applicable = {name: value for name, value in changes.items() if hasattr(settings, name)}
    return replace(settings, **applicable)
