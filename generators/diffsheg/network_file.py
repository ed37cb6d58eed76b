"""A DiffSHEG network with all that its motion depends on, from our files or the authors'.

``released_names.toml`` translates the authors' names of the weights into ours; every weight of the
file must have a place in our network.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np
import torch
from torch import Tensor

from generators.diffsheg.config import BEAT, SHOW, DenoiserConfig
from generators.diffsheg.model import Denoiser
from motion.arrays import Bools, Floats
from motion.errors import InputError
from training.released_weights import ReleasedNames, fill, read_numbers, read_saved, tensors_in
from training.weights_file import NetworkKind, TrainedNetwork, holds_facts

DATASETS: Final[Mapping[str, DenoiserConfig]] = {"beat": BEAT, "show": SHOW}

_NAMES: Final = ReleasedNames.read(Path(__file__).with_name("released_names.toml"))

_STATS_REMEDY: Final = (
    "Name as 'stats' the folder that holds axis_angle_mean.npy, axis_angle_std.npy, "
    "json_mean.npy and json_std.npy, as released with the checkpoint"
)

_LARGEST_ROUNDING: Final = 1e-6
"""Standard deviations below this are rounding errors: such a value is constant."""


@dataclass(frozen=True, eq=False)
class Normalisation:
    """Mean and standard deviation of each value of a frame, the body's first.

    Attributes
    ----------
    mean, std : ndarray, shape (values,)
        A value with a zero `std` is constant.
    """

    mean: Floats
    std: Floats

    def normalised(self, motion: Floats) -> Floats:
        """Return `motion` (T, values), normalised; constant values are 0."""
        return np.asarray((motion - self.mean) / np.where(self._varies, self.std, np.inf))

    def restored(self, normalised: Floats) -> Floats:
        """Return motion (T, values), denormalised; constant values are their mean."""
        return np.asarray(self.mean + self.std * self._varies * normalised)

    @property
    def _varies(self) -> Bools:
        return np.asarray(self.std >= _LARGEST_ROUNDING)


def load_released(path: Path, dataset: Literal["beat", "show"]) -> Denoiser:
    """Return the released network of a data set, in evaluation mode, on the CPU.

    The file is of ``torch.save(state_dict)`` or safetensors, with the weights at the top or under
    the key ``encoder``. Nothing but tensors is unpickled.

    Raises
    ------
    InputError
        If the file cannot be read or is not such a network; the message names weights that are
        missing, unknown or of another shape.
    """
    weights = _NAMES.renamed_weights(read_weights(path))
    with torch.device("meta"):
        denoiser = Denoiser(DATASETS[dataset])
    return fill(
        denoiser,
        weights,
        path,
        f"DiffSHEG's network for {dataset}",
        "Name the dataset it was trained on, or give the released checkpoint",
    )


def read_weights(file: Path) -> dict[str, Tensor]:
    """Return the tensors of a file by name, or those under the key ``encoder`` if it exists.

    Raises
    ------
    InputError
        If the file is missing, or holds anything but tensors.
    """
    content = read_saved(file)
    if isinstance(content, Mapping) and isinstance(content.get("encoder"), Mapping):
        content = content["encoder"]
    if isinstance(content, Mapping) and all(str(name).startswith("encoder.") for name in content):
        content = {name.removeprefix("encoder."): weight for name, weight in content.items()}
    return tensors_in(content, file)


def read_normalisation(folder: Path, config: DenoiserConfig) -> Normalisation:
    """Read the mean and standard deviation files of DiffSHEG's release.

    Parameters
    ----------
    folder : Path
        Folder with ``axis_angle_mean.npy`` and ``axis_angle_std.npy`` of the body, and
        ``json_mean.npy`` and ``json_std.npy`` of the face, which may be in ``facial52/``.
    config : DenoiserConfig
        Configuration with the numbers of values.

    Raises
    ------
    InputError
        If a file is missing, cannot be read, or is of another size.
    """
    parts = (("axis_angle", config.gesture_width), ("json", config.expression_width))
    mean, std = (
        np.concatenate([_read_part(folder, f"{part}_{kind}.npy", width) for part, width in parts])
        for kind in ("mean", "std")
    )
    return Normalisation(mean, std)


def _read_part(folder: Path, name: str, width: int) -> Floats:
    in_folder = folder / "facial52" / name
    path = in_folder if in_folder.is_file() else folder / name
    return read_numbers(path, width, _STATS_REMEDY)


_NETWORK: Final = NetworkKind(name="diffsheg", wanted="a DiffSHEG network")


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionNetwork(TrainedNetwork[Denoiser]):
    """A network that generates motion.

    Attributes
    ----------
    dataset : {'beat', 'show'}
        The data set of its motion representation.
    normalisation : Normalisation
        The normalisation of its values.
    hubert : str or None
        The `Hubert.identity` of its features; None if unknown.
    """

    dataset: str
    normalisation: Normalisation
    hubert: str | None = None


def write_network(path: Path, network: MotionNetwork) -> None:
    """Write a network to one safetensors file, with its sizes, its normalisation and its origin."""
    statistics = {
        f"normalisation.{kind}": torch.from_numpy(getattr(network.normalisation, kind))
        for kind in ("mean", "std")
    }
    facts = {"dataset": network.dataset, "hubert": network.hubert}
    _NETWORK.write(path, network, "denoiser", statistics, **facts)


def load_network(path: Path, dataset: Literal["beat", "show"], stats: Path | None) -> MotionNetwork:
    """Return the network of a file that `write_network` or DiffSHEG's authors wrote.

    Parameters
    ----------
    path : Path
        The checkpoint.
    dataset : {'beat', 'show'}
        The data set of a released checkpoint.
    stats : Path or None
        Folder of its means and standard deviations; see `read_normalisation`.

    Raises
    ------
    InputError
        If the file is not such a network, or a released one has no `stats`.
    """
    if holds_facts(path):
        return _load_trained(path)
    if stats is None:
        read_weights(path)  # first refuses a damaged file
        raise InputError(
            "a released checkpoint lacks the means and standard deviations of its motion",
            where=path,
            remedy=_STATS_REMEDY,
        )
    denoiser = load_released(path, dataset)
    return MotionNetwork(
        model=denoiser,
        dataset=dataset,
        normalisation=read_normalisation(stats, denoiser.config),
    )


def _load_trained(path: Path) -> MotionNetwork:
    with _NETWORK.reading(path) as file:
        facts, config = file.facts, DenoiserConfig(**file.facts["config"])
        if facts["dataset"] not in DATASETS:
            raise ValueError("another data set")
        mean, std = (np.asarray(file.tensors[f"normalisation.{kind}"]) for kind in ("mean", "std"))
        if mean.shape != (config.motion_width,) or std.shape != mean.shape:
            raise ValueError("a normalisation of another size")
        return MotionNetwork(
            model=file.loaded(Denoiser(config), "denoiser"),
            dataset=str(facts["dataset"]),
            normalisation=Normalisation(mean, std),
            speakers=file.speakers(config.speakers),
            hubert=facts["hubert"],
            training=facts["training"],
        )
