"""Options that say which network moves, as whom, and how it samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import Any, Final

import click

from generators.diffsheg.walk import DEFAULT, PRESETS, SamplingSettings
from generators.model_settings import DATASETS, ModelSettings
from motion.errors import InputError
from studyapp.definition.conditions import Condition

_FOLDER: Final = click.Path(file_okay=False, path_type=Path)

_COUNTS: Final = {
    "steps": "Steps from noise to motion: 25.",
    "overlap": "Frames that windows share: 4 of BEAT, 10 of SHOW.",
    "entry": "Steps of a window that continues another: three fifths of all.",
    "jump_length": "Steps that resampling goes back at once: 3.",
    "jump_count": "How often each stretch is walked: 2 fast, 5 careful.",
}


@dataclass(frozen=True, kw_only=True)
class NetworkOptions:
    """What was said of a learned generator, None where nothing was.

    Attributes
    ----------
    checkpoint, dataset, stats, hubert, speaker
        See `generators.model_settings.ModelSettings`.
    sampling : str or None
        Name of a setting.
    steps, overlap, entry, jump_length, jump_count, blend_below
        What differs from it.
    """

    checkpoint: Path | None
    dataset: str | None
    stats: Path | None
    hubert: Path | None
    speaker: str | None
    sampling: str | None
    steps: int | None
    overlap: int | None
    entry: int | None
    jump_length: int | None
    jump_count: int | None
    blend_below: float | None

    @property
    def given(self) -> tuple[str, ...]:
        """The options that were given."""
        names = (field.name for field in fields(self))
        return tuple(
            f"--{name.replace('_', '-')}" for name in names if getattr(self, name) is not None
        )

    def model(self, device: str) -> ModelSettings | None:
        """Return the network that is meant; None where no checkpoint is named.

        Raises
        ------
        InputError
            If options are of a network and none is named, or one is not usable.
        """
        if self.checkpoint is None:
            if self.given:
                raise InputError(
                    f"{self.given[0]} is of a learned generator",
                    remedy="Give its --checkpoint, or leave the option out",
                )
            return None
        speaker = self.speaker
        return ModelSettings(
            checkpoint=self.checkpoint,
            dataset=self.dataset or "beat",
            stats=self.stats,
            hubert=self.hubert,
            speaker=int(speaker) if speaker is not None and speaker.isdecimal() else speaker,
            sampling=SamplingSettings(
                preset=self.sampling or DEFAULT,
                **{name: getattr(self, name) for name in (*_COUNTS, "blend_below")},
            ),
            device=device,
        )

    def condition(self, generator: str, folder: Path) -> Condition | None:
        """Return the condition of a study in `folder` that moves so; None without a checkpoint.

        Files outside the folder are named by their full path.

        Raises
        ------
        InputError
            As `model`.
        """
        model = self.model("cpu")
        if model is None:
            return None
        paths = {
            key: named_from(folder, path)
            for key, path in (
                ("checkpoint", self.checkpoint),
                ("stats", self.stats),
                ("hubert", self.hubert),
            )
            if path is not None
        }
        sampling = {
            "preset": self.sampling,
            **{name: getattr(self, name) for name in (*_COUNTS, "blend_below")},
        }
        said = {key: value for key, value in sampling.items() if value is not None}
        return Condition.model_validate(
            {
                "generator": generator,
                **paths,
                "dataset": self.dataset,
                "speaker": model.speaker,
                "sampling": said or None,
            }
        )


def named_from(folder: Path, path: Path) -> str:
    """Return how a study in `folder` names a file: from there, or in full where it lies outside."""
    there, base = path.resolve(), folder.resolve()
    return str(there.relative_to(base) if there.is_relative_to(base) else there)


def network_options(function: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of a learned generator, as its argument `network`."""

    @wraps(function)
    def with_network(**arguments: Any) -> None:
        own = {field.name: arguments.pop(field.name) for field in fields(NetworkOptions)}
        function(network=NetworkOptions(**own), **arguments)

    options = [
        click.option(
            "--checkpoint",
            type=click.Path(dir_okay=False, path_type=Path),
            help="Weights of a learned generator.",
        ),
        click.option(
            "--dataset", type=click.Choice(DATASETS), help="What a release learned: beat."
        ),
        click.option("--stats", type=_FOLDER, help="Means and deviations of a release."),
        click.option("--hubert", type=_FOLDER, help="HuBERT's weights; else a stand-in hears."),
        click.option("--speaker", help="As which of its speakers it moves: number or name."),
        click.option(
            "--sampling",
            type=click.Choice(list(PRESETS)),
            help=f"How windows are sampled; fast and careful as released: {DEFAULT}.",
        ),
        *(
            click.option(f"--{name.replace('_', '-')}", type=int, help=what)
            for name, what in _COUNTS.items()
        ),
        click.option("--blend-below", type=float, help="Noise below which windows blend: 0.2."),
    ]
    decorated: Callable[..., None] = with_network
    for option in reversed(options):
        decorated = option(decorated)
    return decorated
