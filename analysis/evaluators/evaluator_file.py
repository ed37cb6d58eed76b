"""The file of a feature network: one safetensors file with everything that its scores depend on."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, Literal

import torch
from pydantic import Field, ValidationError
from torch import Tensor

from analysis.evaluators.design import SIZES, Design, Facts, Network
from analysis.evaluators.examples import Normalisation
from analysis.evaluators.networks import AutoencoderConfig, EmotionConfig
from motion.body.face_landmarks import FaceLandmarks
from motion.errors import InputError, found_at
from training.weights_file import WeightsFile, read_weights, write_weights

_FORMAT: Final = 2

_REMEDY: Final = "Give a file as 'motionjury train evaluator' wrote it, or train again"


class DataFacts(Facts):
    """The data a network was trained on.

    Attributes
    ----------
    sha256 : str
        Hash of the motion files, their recordings and emotions.
    clips, recordings : int
        Number of clips and of their recordings.
    windows, held_out_windows : int
        Windows for training, and held-out windows.
    held_out : str
        What was held out, in words.
    """

    sha256: str = Field(pattern="^[0-9a-f]{64}$")
    clips: int
    recordings: int
    windows: int
    held_out_windows: int
    held_out: str


class TrainingFacts(Facts):
    """The training of a network.

    Attributes
    ----------
    config : mapping
        `training.config.TrainingConfig`, as JSON holds it.
    best_step : int
        Step with the best weights on held-out windows, which the file holds.
    last_loss : float
        Loss of the last step.
    versions : mapping of str to str
        Of packages.
    """

    config: dict[str, Any]
    best_step: int
    last_loss: float
    versions: dict[str, str]


class EvaluatorFacts(Design):
    """The metadata of a file: the network's design, data and training.

    Attributes
    ----------
    data : DataFacts
        The data.
    training : TrainingFacts
        The training.
    held_out : mapping of str to float
        Measured on held-out windows.
    """

    format: Literal[2] = _FORMAT
    data: DataFacts
    training: TrainingFacts
    held_out: dict[str, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class EvaluatorFile:
    """A network with everything that it needs.

    Attributes
    ----------
    facts : EvaluatorFacts
        Its metadata.
    network : Network
        In evaluation mode, on the processor.
    normalisation : Normalisation
        Of its channels.
    landmarks : FaceLandmarks or None
        For the kind ``face``.
    """

    facts: EvaluatorFacts
    network: Network
    normalisation: Normalisation
    landmarks: FaceLandmarks | None


def write_evaluator(path: Path, evaluator: EvaluatorFile) -> None:
    """Write `evaluator` to `path` in one step; equal ones make equal bytes."""
    tensors: dict[str, Tensor] = {
        f"network.{name}": tensor for name, tensor in evaluator.network.state_dict().items()
    }
    tensors["normalisation.mean"] = torch.from_numpy(evaluator.normalisation.mean)
    tensors["normalisation.deviation"] = torch.from_numpy(evaluator.normalisation.deviation)
    if evaluator.landmarks is not None:
        tensors |= {
            f"landmarks.{name}": torch.from_numpy(array)
            for name, array in evaluator.landmarks.arrays().items()
        }
    facts = evaluator.facts.model_dump(mode="json") | {"network": asdict(evaluator.facts.network)}
    write_weights(path, tensors, facts)


def read_evaluator(path: Path) -> EvaluatorFile:
    """Read what `write_evaluator` wrote.

    Raises
    ------
    InputError
        If the file is missing, damaged, another program's, of another version or changed.
    """
    file = read_weights(path)
    with found_at(path):
        facts = _facts(file)
        landmarks = None
        if facts.channels == "landmarks":
            arrays = {
                name: tensor.numpy() for name, tensor in file.with_prefix("landmarks").items()
            }
            landmarks = FaceLandmarks.from_arrays(arrays)
        channels = facts.view(landmarks).channels
        return EvaluatorFile(
            facts=facts,
            network=_network(file, facts, channels),
            normalisation=_normalisation(file, channels),
            landmarks=landmarks,
        )


def _facts(file: WeightsFile) -> EvaluatorFacts:
    if "kind" not in file.facts:
        raise InputError("the file holds weights, but no feature network", remedy=_REMEDY)
    if file.facts.get("format") != _FORMAT:
        raise InputError(
            f"the feature network is of format {file.facts.get('format')!r}, not {_FORMAT}",
            remedy="Use the version of the program that trained it, or train again",
        )
    if file.facts["kind"] not in SIZES:
        raise InputError(
            f"the feature network is of an unknown kind, {file.facts['kind']!r}", remedy=_REMEDY
        )
    config = EmotionConfig if file.facts["kind"] == "emotion" else AutoencoderConfig
    try:
        network = config(**_lists_as_tuples(file.facts["network"]))
        return EvaluatorFacts.model_validate({**file.facts, "network": network})
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        raise InputError(
            f"what the file says of its network is unusable: {key}: {first['msg']}",
            remedy=_REMEDY,
        ) from error
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"what the file says of its network's sizes is unusable: {error}", remedy=_REMEDY
        ) from error


def _lists_as_tuples(sizes: dict[str, Any]) -> dict[str, Any]:
    return {
        name: tuple(value) if isinstance(value, list) else value for name, value in sizes.items()
    }


def _network(file: WeightsFile, design: Design, channels: int) -> Network:
    network = design.fresh_network(channels)
    try:
        network.load_state_dict(file.with_prefix("network"))
    except RuntimeError as error:
        raise InputError("the weights do not fit the network's sizes", remedy=_REMEDY) from error
    return network.eval().requires_grad_(False)


def _normalisation(file: WeightsFile, channels: int) -> Normalisation:
    arrays = {name: tensor.numpy() for name, tensor in file.with_prefix("normalisation").items()}
    for name in ("mean", "deviation"):
        if name not in arrays or arrays[name].shape != (channels,):
            raise InputError(f"the {name} of the channels does not fit", remedy=_REMEDY)
    if not (arrays["deviation"] > 0).all():
        raise InputError("the deviation of a channel is not above 0", remedy=_REMEDY)
    return Normalisation(mean=arrays["mean"], deviation=arrays["deviation"])
