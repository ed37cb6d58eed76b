"""What a learned generator is given: files of weights and who speaks. Nothing is loaded here."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final

from generators.diffsheg.walk import SamplingSettings
from motion.errors import InputError

DATASETS: Final = ("beat", "show")
DEVICES: Final = ("cpu", "cuda")


@dataclass(frozen=True, kw_only=True)
class ModelSettings:
    """Which network moves, and as whom.

    Attributes
    ----------
    checkpoint : Path
        The network's weights.
    dataset : {'beat', 'show'}
        What a released checkpoint was trained on; files trained here know it themselves.
    stats : Path or None
        Folder of means and standard deviations, which a released checkpoint needs.
    hubert : Path or None
        Folder of HuBERT's weights; None for a stand-in that hears no words.
    speaker : int, str or None
        Number of the speaker in the data set, from 1, or the name where the checkpoint knows names.
        None for who speaks in the segment, as far as the checkpoint knows names; else the first.
    sampling : SamplingSettings
        How windows are sampled.
    device : {'cpu', 'cuda'}
        Where the network runs. Another device rounds otherwise, as another number of threads does,
        and makes no clip anew.

    Raises
    ------
    InputError
        If a file or folder is not there, or a value is unknown.
    """

    checkpoint: Path
    dataset: str = "beat"
    stats: Path | None = None
    hubert: Path | None = None
    speaker: int | str | None = None
    sampling: SamplingSettings = field(default_factory=SamplingSettings)
    device: str = "cpu"

    def __post_init__(self) -> None:
        if not self.checkpoint.is_file():
            raise InputError(
                "there is no such checkpoint", where=self.checkpoint, remedy="Check the path"
            )
        for what, folder in (("stats", self.stats), ("hubert", self.hubert)):
            if folder is not None and not folder.is_dir():
                raise InputError(
                    f"there is no such folder of {what}", where=folder, remedy="Check the path"
                )
        if self.dataset not in DATASETS:
            raise InputError(
                f"there is no data set {self.dataset!r}", remedy=f"Use one of {', '.join(DATASETS)}"
            )
        if isinstance(self.speaker, int) and self.speaker < 1:
            raise InputError(
                f"there is no speaker {self.speaker}", remedy="Give the speaker's number, from 1"
            )
        if self.device not in DEVICES:
            raise InputError(
                f"there is no device {self.device!r}", remedy=f"Use one of {', '.join(DEVICES)}"
            )

    @cached_property
    def checkpoint_sha256(self) -> str:
        """Hash of the checkpoint's file."""
        return _sha256(self.checkpoint)

    def fingerprint(self) -> tuple[object, ...]:
        """Return what changes with the content of any file and with any value but the device."""
        folders = [
            (path.name, _sha256(path))
            for folder in (self.stats, self.hubert)
            if folder is not None
            for path in sorted(folder.rglob("*"))
            if path.is_file()
        ]
        sampling = (self.sampling.overlap, self.sampling.sampling(overlap=0))
        return (self.checkpoint_sha256, self.dataset, self.speaker, sampling, *folders)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
