"""Self-penetration of motion files: computed once per clip and body, and kept on disk."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.kept_arrays import KeptArrays
from analysis.measurement.seen_motion import SeenMotion
from analysis.metrics.self_penetration import PenetrableBody
from motion.body import read_body
from motion.errors import InputError

VERSION: Final = "1"
"""Raised whenever depths of the same motion file on the same body come out otherwise."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Depths:
    """How deep a clip's arms are inside the body.

    Attributes
    ----------
    metres : ndarray, shape (n,), float32
        By sampled frame; empty where the file cannot be used.
    kept : Path or None
        Where they are kept.
    """

    metres: NDArray[np.float32]
    kept: Path | None = None


@dataclass(frozen=True, kw_only=True)
class DepthsOf:
    """Puts motion files on a body; it travels to other processes.

    Attributes
    ----------
    body : Path
        File of the body.
    sha256 : str
        Its hash.
    motion : SeenMotion
        How motion files are read.
    folder : Path or None
        Where depths are kept between runs.
    """

    body: Path
    sha256: str
    motion: SeenMotion
    folder: Path | None

    @classmethod
    def on(cls, body: Path, motion: SeenMotion, folder: Path | None) -> DepthsOf:
        """Return what puts files on the body in file `body`.

        Raises
        ------
        InputError
            If the body cannot be read.
        """
        _penetrable(body)
        digest = hashlib.sha256(body.read_bytes()).hexdigest()
        return cls(body=body, sha256=digest, motion=motion, folder=folder)

    @property
    def described(self) -> str:
        """Which body it is, for a footnote."""
        return f"{self.body.stem}, file {self.sha256[:16]}"

    def __call__(self, path: Path) -> Depths:
        """Return the depths of the motion file `path`; none where it cannot be used."""
        try:
            return self._depths(path)
        except InputError:
            return Depths(metres=np.zeros(0, np.float32))

    def forget_others(self, used: set[Path]) -> None:
        """Remove depths on this body that are kept but not `used`."""
        if self.folder is not None:
            _kept(self.folder).forget(self._settings, used)

    def _depths(self, path: Path) -> Depths:
        place = None
        if self.folder is not None:
            place = _kept(self.folder).place(path, self._settings)
            found = KeptArrays.read(place, (None,))
            if found is not None:
                return Depths(metres=found, kept=place)
        depths = _penetrable(self.body).depths(self.motion.read(path))
        if place is not None:
            KeptArrays.keep(place, depths)
        return Depths(metres=depths, kept=place)

    @property
    def _settings(self) -> str:
        return f"{self.sha256} {self.motion}"


@lru_cache(maxsize=2)
def _penetrable(body: Path) -> PenetrableBody:
    return PenetrableBody.of(read_body(body))


@lru_cache(maxsize=8)
def _kept(folder: Path) -> KeptArrays:
    return KeptArrays(folder, "depths", VERSION)
