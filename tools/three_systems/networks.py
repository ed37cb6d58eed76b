"""The networks of the three systems and the feature networks of metrics, given or trained."""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from motion.errors import InputError
from motion.files import digest
from tools.three_systems.line import Line, places
from training.weights_file import read_weights

NETWORKS: Final = ("amuse-speech", "amuse", "diffsheg", "s2ue")
"""Names for `motionjury train`. AMUSE's motion network needs its speech model first."""

EVALUATORS: Final[Mapping[str, Sequence[str]]] = MappingProxyType(
    {
        "emotion": ("emotion",),
        "gesture": ("motion", "--channels", "gesture"),
        "expression": ("motion", "--channels", "expression"),
        "both": ("motion", "--channels", "both"),
        "face": ("face",),
    }
)
"""Feature networks of all metrics of the three papers, and their options."""


@dataclass(frozen=True, kw_only=True)
class Network:
    """One network of a system.

    Attributes
    ----------
    name : str
        Its name for `motionjury train`.
    file : Path
        Its weights.
    is_given : bool
        Whether it was given rather than trained by this page's command.
    """

    name: str
    file: Path
    is_given: bool

    @property
    def training(self) -> Mapping[str, Any]:
        """Its training as recorded in its file."""
        facts: Mapping[str, Any] = read_weights(self.file).facts["training"]
        return facts


def networks(
    line: Line, corpus: Path, given: Mapping[str, Path | None], steps: int | None
) -> list[Network]:
    """Return the four networks of the three systems, training those that are not given."""
    trained: dict[str, Network] = {}
    for name in NETWORKS:
        file = given.get(name)
        if file is not None:
            if not file.is_file():
                raise InputError("the network does not exist", where=file, remedy="Check the path")
            trained[name] = Network(name=name, file=file.resolve(), is_given=True)
            continue
        out = line.folder / "networks" / f"{name}.safetensors"
        words = ["train", name, "--data", *places([corpus], line.folder), "--config", "tiny"]
        if name == "amuse":
            words += ["--speech-model", *places([trained["amuse-speech"].file], line.folder)]
        words += ["--out", *places([out], line.folder), *_of_steps(steps)]
        line.run(
            *words,
            of=digest(*(network.file for network in trained.values())) if name == "amuse" else "",
        )
        trained[name] = Network(name=name, file=out, is_given=False)
    return list(trained.values())


def evaluators(line: Line, recordings: str, into: Path, steps: int | None) -> None:
    """Train the feature networks on a study's recordings, and copy them into the folder `into`."""
    into.mkdir(parents=True, exist_ok=True)
    for name, kind in EVALUATORS.items():
        out = f"evaluators/{name}.safetensors"
        words = [*kind, "--data", recordings, "--config", "tiny", "--out", out, *_of_steps(steps)]
        line.run("train", "evaluator", *words)
        shutil.copyfile(line.folder / out, into / f"{name}.safetensors")


def _of_steps(steps: int | None) -> list[str]:
    """Return the option for `steps`; by default the config's own apply."""
    return [] if steps is None else ["--steps", str(steps)]
