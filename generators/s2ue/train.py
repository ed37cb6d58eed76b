"""Training Speech2UnifiedExpressions on recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from generators.s2ue.config import ABLATIONS, PRESETS, LossWeights, NetworkConfig
from generators.s2ue.losses import diversity_loss, phoneme_loss, reconstruction_losses
from generators.s2ue.model import Network
from generators.s2ue.network_file import S2ueNetwork, write_network
from generators.teaching import learn, prepared_takes
from generators.trainable import TrainedGenerator, TrainingRequest
from motion.errors import InputError
from motion.face_landmarks import FaceLandmarks
from training.adversarial import discriminator_loss, generator_loss
from training.batch_order import evenly
from training.data.feature_cache import PreparedTakes
from training.data.windows import Windows
from training.hearing.word_vectors import StandIn, WordVectors, vectors_of
from training.launching import is_leader
from training.point_features import features_of
from training.spaces.anatomy import components_of, lips_of
from training.spaces.bone_tensors import split_motion
from training.spaces.bones_and_landmarks import BONE_VALUES, joints_of
from training.spaces.normalisation import mean_and_deviation, spread
from training.speaker_latent import latent_loss
from training.speakers import Speakers
from training.window_task import WindowTask

STRIDE: Final = 10
"""Frames from one window of a take to the next, as the TED Gesture data is cut."""

HELD_OUT: Final = 256
"""At most so many windows tell how well held-out takes are known."""

_SEEN: Final = 4_000
"""At most so many windows tell how the values of recordings spread."""


@dataclass(frozen=True, kw_only=True)
class _Batch:
    """Windows: motion, MFCC, spectrogram, vectors of words, one-hot speakers."""

    motion: Tensor
    sound: Tensor
    spectrum: Tensor
    words: Tensor
    person: Tensor


@dataclass(frozen=True, kw_only=True, eq=False)
class S2ueTask(WindowTask):
    """Learning to move as somebody does who says something, from how they began.

    Attributes
    ----------
    config : NetworkConfig
        The networks.
    weights : LossWeights
        What counts how much.
    face : FaceLandmarks
        Whose shifts motion tells.
    training, held_out : Windows
        Of the features ``motion``, ``sound``, ``spectrum`` and ``words``.
    speakers : Speakers
        Whom it learns from.
    rest : ndarray, shape (values,)
        The mean first frame of the takes to learn from.
    """

    config: NetworkConfig
    weights: LossWeights
    face: FaceLandmarks
    speakers: Speakers
    rest: NDArray[np.float32]

    def network(self) -> Network:
        """Return fresh networks, which know how the values of the recordings spread."""
        network = Network(self.config, self.face.neutral)
        for name, values in self._spreads.items():
            network.get_buffer(name).copy_(torch.from_numpy(values))
        return network.to(self.device)

    def losses(self, network: Network, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return the generator's losses."""
        return self.losses_of("generator", network, rows)

    def losses_of(
        self, name: str, network: Network, rows: NDArray[np.int64]
    ) -> Mapping[str, Tensor]:
        """Return the losses of generator, discriminator or phoneme predictor."""
        batch = self._batch(self.training, rows)
        if name == "phonemes":
            return {"loss": self._phonemes(network, batch)}
        noise = self._noise(len(rows))
        if name == "discriminator":
            with torch.no_grad():
                found, _ = self._told(network, batch, batch.person, noise)
            return {"loss": discriminator_loss(network.judged(batch.motion), network.judged(found))}
        found, latents = self._told(network, batch, batch.person, noise)
        parts = reconstruction_losses(network, found, batch.motion, self.weights)
        total = parts["reconstruction"]
        if self.weights.latent:
            parts["latent"] = latent_loss(latents)
            total = total + self.weights.latent * parts["latent"]
        if self.weights.diversity and len(self.speakers.names) > 1:
            other, _ = self._told(network, batch, self._others(batch.person), noise)
            parts["diversity"] = diversity_loss(
                network, found, other, batch.motion, self.weights.margin
            )
            total = total + self.weights.diversity * parts["diversity"]
        if self.weights.adversarial:
            parts["adversarial"] = generator_loss(network.judged(found))
            total = total + self.weights.adversarial * parts["adversarial"]
        return {"loss": total, **parts}

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return equations 17 and 16 of held-out windows, as their speakers on the average.

        All of equation 17 counts, whatever is learned by, so that ablations are measured alike.
        """
        rows = evenly(len(self.held_out), HELD_OUT)
        batch = self._batch(self.held_out, rows)
        noise = torch.zeros_like(self._noise(len(rows)))
        found, _ = self._told(network, batch, batch.person, noise)
        measured = reconstruction_losses(network, found, batch.motion, LossWeights())
        if self.config.faces:
            measured["phonemes"] = self._phonemes(network, batch)
            measured = {"missed": measured["reconstruction"] + measured["phonemes"], **measured}
        return {name: float(value) for name, value in measured.items()}

    def _told(
        self, network: Network, batch: _Batch, person: Tensor, noise: Tensor
    ) -> tuple[Tensor, list[tuple[Tensor, Tensor]]]:
        seeds = batch.motion[:, : self.config.seeds]
        return network.synthesise(batch.sound, batch.words, person, noise, seeds)

    def _phonemes(self, network: Network, batch: _Batch) -> Tensor:
        true = split_motion(batch.motion)["face"][:, :, list(self.config.lips)]
        return phoneme_loss(network.lips(batch.spectrum), true, network.spread[0])

    def _noise(self, windows: int) -> Tensor:
        shape = (windows, len(self.config.modalities), self.config.speaker_width)
        return torch.randn(shape).to(self.device)

    def _others(self, person: Tensor) -> Tensor:
        """Return one-hot vectors of speakers other than those."""
        count = len(self.speakers.names)
        further = torch.randint(1, count, (len(person),)).to(self.device)
        others = (person.argmax(dim=1) + further) % count
        return torch.eye(self.config.speakers, device=person.device)[others]

    def _batch(self, windows: Windows, rows: NDArray[np.int64]) -> _Batch:
        values = windows.batch(rows)
        people = self.speakers.one_hot([windows.take_of(int(row)).speaker for row in rows])
        told = {name: torch.from_numpy(one).to(self.device) for name, one in values.items()}
        return _Batch(person=torch.from_numpy(people).to(self.device), **told)

    @cached_property
    def _spreads(self) -> dict[str, NDArray[np.float32]]:
        """The buffers of a network: means and deviations over windows, evenly among all."""
        seen = self.training.batch(evenly(self.examples, _SEEN))
        flat = {
            name: one.reshape(-1, one.shape[-1]).astype(np.float64) for name, one in seen.items()
        }
        motion = flat["motion"]
        pose, face = motion[:, :BONE_VALUES], motion[:, BONE_VALUES:]
        joints = joints_of(pose.reshape(len(pose), -1, 3)).reshape(len(pose), -1)
        mean, deviation = mean_and_deviation(motion)
        found = {
            "mean": mean,
            "deviation": deviation,
            "spread": np.array([spread(one) for one in (face, pose, joints)]),
            "rest": self.rest,
            **{name: np.stack(mean_and_deviation(flat[name])) for name in ("sound", "spectrum")},
        }
        return {name: one.astype(np.float32) for name, one in found.items()}


def train_s2ue(request: TrainingRequest) -> TrainedGenerator:
    """Train Speech2UnifiedExpressions; see `generators.trainable.TrainGenerator`."""
    preset = PRESETS[request.config]
    ablation = request.choices.get("ablation")
    vectors = vectors_of(request.choices.get("vectors"))
    face = FaceLandmarks.of_default_body()
    config, weights = _chosen(request, ablation, vectors, face)
    if request.takes.kind == "ted" and config.faces:
        raise InputError(
            "recordings of the layout 'ted' have no face",
            remedy="Train with --ablation without_face, or give recordings with faces",
        )
    kind, rate = request.takes.kind, config.frame_rate
    features = features_of(kind, face, vectors, rate, faces=config.faces)
    prepared = prepared_takes(request, features, rate)
    names = prepared.taught(request.takes.speakers)
    config = replace(config, speakers=len(names))
    task = S2ueTask(
        config=config,
        weights=weights,
        face=face,
        training=Windows(prepared, split="train", frames=config.frames, stride=STRIDE),
        held_out=Windows(prepared, split="validation", frames=config.frames, stride=config.frames),
        speakers=Speakers(names, len(names)),
        rest=prepared.mean_first("motion"),
        further={"speakers": list(names), "vectors": vectors.description},
        device=request.device,
    )
    training = preset.training.changed(
        request.changes, epochs=preset.epochs, examples=task.examples
    )
    used = {"generator": True, "discriminator": weights.adversarial, "phonemes": config.faces}
    passes = tuple(one for one in training.passes if used[one.name])
    training = replace(training, passes=passes)
    trained, facts = learn(request, task, training)
    facts |= {"losses": asdict(weights)}
    if is_leader():
        write_network(
            request.out,
            S2ueNetwork(
                network=trained.network.cpu(),
                speakers=task.speakers,
                vectors=vectors.description,
                training=facts,
            ),
        )
    return _said(task, prepared, vectors, trained.best.step, trained.best.measured)


def _chosen(
    request: TrainingRequest, ablation: str | None, vectors: WordVectors, face: FaceLandmarks
) -> tuple[NetworkConfig, LossWeights]:
    """Return sizes and weights with the ablation's changes; the speakers are not counted yet."""
    config = NetworkConfig(
        components=components_of(face.actions),
        lips=lips_of(face.actions),
        speakers=1,
        words=vectors.width,
        **PRESETS[request.config].sizes,
    )
    changes = {} if ablation is None else ABLATIONS[ablation]
    of_losses = {name: value for name, value in changes.items() if hasattr(LossWeights, name)}
    of_network = {name: value for name, value in changes.items() if name not in of_losses}
    return replace(config, **of_network), replace(LossWeights(), **of_losses)


def _said(
    task: S2ueTask,
    prepared: PreparedTakes,
    vectors: WordVectors,
    step: int,
    measured: Mapping[str, float],
) -> TrainedGenerator:
    takes = [take for take in prepared.takes if take.split == "train"]
    told = sum(take.transcript is not None for take in takes)
    sentences = (
        f"Learned from {len(task.training)} windows of {len(takes)} takes by "
        f"{len(task.speakers.names)} speakers ({', '.join(task.speakers.names)}); {told} takes "
        "have a transcript.",
        f"In {len(task.held_out)} held-out windows its motion is off by "
        f"{measured['reconstruction']:.3f} of how far motion spreads (equation 17).",
        f"Its weights are those of step {step}.",
    )
    warnings = []
    if isinstance(vectors, StandIn):
        warnings.append(f"Words had a {vectors.description}; name FastText's with --vectors.")
    if not told:
        warnings.append("It learned from sound alone: no recording has a transcript beside it.")
    return TrainedGenerator(sentences=sentences, warnings=tuple(warnings), skipped=prepared.skipped)
