"""The compared networks of DiffSHEG and AMUSE, and the networks that judge them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Final

import torch

from analysis.evaluators.clip_views import Channels
from analysis.evaluators.training import PRESETS, ClipSource, EvaluatorRequest, train_evaluator
from generators.diffsheg.model import Denoiser
from generators.diffsheg.network_file import load_network, write_network
from generators.registry import TRAINABLE, TrainingRequest
from motion.files import sha256_of
from motion.formats import read_clip
from studyapp.cli.output import progress
from training.data.take import Take, TakeFolder

SYSTEMS: Final = ("diffsheg", "amuse")

ABLATIONS: Final = ("without_alignment", "disjoint", "without_prior", "mfcc")
"""Ablations of AMUSE: appendix C.3, Table A.4 and both of Table A.3."""

STEPS: Final = MappingProxyType({"diffsheg": 1_500})
"""Steps instead of the configs', so that all networks are trained within an hour and a half."""

JUDGES: Final[tuple[tuple[str, str, Channels], ...]] = (
    ("gesture", "motion", "gesture"),
    ("expression", "motion", "expression"),
    ("emotion", "emotion", "body"),
    ("speaker", "emotion", "body"),
)
"""Feature networks: for FGD, for FED, AMUSE's M for emotions, and the same for speakers."""


@dataclass(frozen=True, kw_only=True)
class Network:
    """A network trained on the corpus.

    Attributes
    ----------
    system : {'diffsheg', 'amuse', 'amuse-speech'}
        The system that it belongs to.
    seed : int
        Seed of its training.
    ablation : str or None
        Its ablation, if any.
    """

    system: str
    seed: int
    ablation: str | None = None

    @property
    def name(self) -> str:
        """Name of its file and its condition."""
        left_out = f"_{self.ablation}" if self.ablation else ""
        return f"{self.system}{left_out}_{self.seed}".replace("-", "_")

    @property
    def hears_by(self) -> Network | None:
        """The speech model that AMUSE's motion networks learn from."""
        if self.system != "amuse":
            return None
        left_out = "mfcc" if self.ablation == "mfcc" else None
        return Network(system="amuse-speech", seed=self.seed, ablation=left_out)

    def files(self, folder: Path) -> dict[str, Path]:
        """Return the files of its generator, by a study's keys."""
        hears_by = {} if self.hears_by is None else {"speech_model": self.hears_by.file(folder)}
        return {"checkpoint": self.file(folder), **hears_by}

    def file(self, folder: Path) -> Path:
        """Return the path of its weights in a folder."""
        return folder / f"{self.name}.safetensors"


def train_network(
    takes: TakeFolder, network: Network, folder: Path, *, cache: Path, steps: int | None = None
) -> Path:
    """Train the tiny config of a network and its speech model, unless they exist.

    Parameters
    ----------
    takes : TakeFolder
        The corpus.
    network : Network
        The network.
    folder : Path
        Folder for its weights.
    cache : Path
        Folder for the takes' features.
    steps : int, optional
        Steps instead of the config's.
    """
    out = network.file(folder)
    if out.exists():
        return out
    choices = {} if network.ablation is None else {"ablation": network.ablation}
    if network.hears_by is not None:
        speech = train_network(takes, network.hears_by, folder, cache=cache, steps=steps)
        choices["speech_model"] = str(speech)
        if network.hears_by.ablation is not None:
            del choices["ablation"]
    changes: dict[str, object] = {"seed": network.seed}
    if steps is not None or network.system in STEPS:
        changes["steps"] = steps or STEPS[network.system]
    with progress(network.name, "step") as show:
        request = TrainingRequest(
            takes=takes,
            out=out,
            cache=cache,
            config="tiny",
            changes=changes,
            choices=choices,
            show_preparing=show,
            show_training=show,
        )
        TRAINABLE[network.system].load()(request)
    return out


def write_untrained(trained: Path, out: Path) -> None:
    """Write the initial state of DiffSHEG's network `trained`."""
    network = load_network(trained, "beat", None)
    with torch.random.fork_rng():
        torch.manual_seed(network.training["config"]["seed"])
        first = Denoiser(network.model.config)
    # The linear estimate of the noise is fitted to the recordings before the first step.
    weights = network.model.state_dict()
    fitted = {name: weight for name, weight in weights.items() if ".skip." in name}
    first.load_state_dict(fitted, strict=False)
    write_network(out, replace(network, model=first.eval(), training={"steps": 0}))


def train_evaluators(
    takes: Sequence[Take], clips: Mapping[str, Path], folder: Path, *, steps: int | None
) -> dict[str, Path]:
    """Train the feature networks on recorded clips unless their files exist.

    Returns
    -------
    dict of str to Path
        Files by name, as in `JUDGES`; ``speaker`` is trained with speakers as emotions.
    """
    networks_by_name = {}
    for name, kind, channels in JUDGES:
        out = networks_by_name[name] = folder / f"{name}.safetensors"
        if out.exists():
            continue
        sources = [
            ClipSource(
                name=take.name,
                recording=take.name,
                emotion=take.speaker if name == "speaker" else take.emotion,
                sha256=sha256_of(clips[take.name]),
                read=partial(read_clip, clips[take.name]),
            )
            for take in takes
        ]
        changes = {} if steps is None else {"steps": steps}
        request = EvaluatorRequest(channels=channels, preset=PRESETS[kind]["tiny"], changes=changes)
        train_evaluator(request, sources, out)
    return networks_by_name
