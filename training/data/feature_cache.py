"""Features of many takes, computed once and kept."""

from __future__ import annotations

import errno
import fcntl
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.clip import check_frame_rate
from motion.errors import InputError
from training.data.kept_files import KeptArray, content_sha256, hashes_of, open_array, write_array
from training.data.take import LONGEST_DIFFERENCE, Feature, Take, TakeFolder

FloatArray = NDArray[np.float32]
Show = Callable[[int, int, str], None]
"""Told how many takes are done, of how many, and the name of the last."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PreparedTakes:
    """Takes whose features can be read.

    Attributes
    ----------
    takes : tuple of Take
        In order of their names.
    arrays : mapping of str to tuple of ndarray
        By feature, for each take (frames, channels), float32. They lie on disk, and are read where
        they are looked at. All features of a take have the same frames.
    frame_rate : float
        Frames per second.
    skipped : tuple of InputError
        Takes that could not be used, and why; those of the folder come first.
    sha256 : str
        Hash of all of it: names, splits, speakers, emotions and features of the takes.
    """

    takes: tuple[Take, ...]
    arrays: Mapping[str, tuple[FloatArray, ...]]
    frame_rate: float
    skipped: tuple[InputError, ...]
    sha256: str

    def frames(self, index: int) -> int:
        """Return how many frames take `index` has."""
        return len(next(iter(self.arrays.values()))[index])

    def taught(self, speakers: Sequence[str]) -> tuple[str, ...]:
        """Return those of `speakers`, in their order, whose takes are learned from."""
        taught = {take.speaker for take in self.takes if take.split == "train"}
        return tuple(name for name in speakers if name in taught)

    def mean_first(self, feature: str) -> FloatArray:
        """Return the mean first frame (channels,) of a feature in the takes to learn from."""
        firsts = [
            values[0]
            for take, values in zip(self.takes, self.arrays[feature], strict=True)
            if take.split == "train"
        ]
        return np.asarray(np.mean(firsts, axis=0), np.float32)


def prepare(
    takes: TakeFolder,
    features: Sequence[Feature],
    cache: Path,
    *,
    frame_rate: float,
    show: Show | None = None,
) -> PreparedTakes:
    """Compute features of all takes, or find them where an earlier call left them.

    What is found was computed by the same version of the feature from files of the same content.
    May be stopped at any time and called again, and by several processes at once, which then share
    the work. Everything below `cache` may be removed at any other time.

    Parameters
    ----------
    takes : TakeFolder
        The takes.
    features : sequence of Feature
        What is wanted of each, at least one; their names differ.
    cache : Path
        Folder that keeps what was computed: a folder a take, a ``.npy`` a feature.
    frame_rate : float
        Frames per second of all features.
    show : callable, optional
        Told about progress.

    Returns
    -------
    PreparedTakes
        A take is skipped where a feature cannot be computed, holds a value that is not finite, or
        lasts longer than another by more than `LONGEST_DIFFERENCE`; features are cut to the
        shortest.

    Raises
    ------
    InputError
        If no take can be used, or the cache cannot be written.
    """
    names = [feature.name for feature in features]
    if not names or len(set(names)) != len(names):
        raise ValueError(f"features need names that differ: {names}")
    check_frame_rate(frame_rate)
    found: dict[str, dict[str, KeptArray]] = {}
    bad: dict[str, InputError] = {}
    try:
        for take in _in_turn(takes.takes, cache):
            try:
                found[take.name] = _all_kept(take, features, frame_rate, cache / take.name)
            except InputError as error:
                bad[take.name] = _named(take, error)
            if show:
                show(len(found) + len(bad), len(takes.takes), take.name)
    except OSError as error:
        raise InputError(
            f"features cannot be kept ({error.strerror})",
            where=cache,
            remedy="Free space there, or name another folder for them",
        ) from error
    skipped = (*takes.skipped, *(bad[name] for name in sorted(bad)))
    if not found:
        raise InputError(
            f"none of the {len(takes.takes)} takes can be used"
            + (f"; the first: {skipped[0]}" if skipped else ""),
            where=cache,
            remedy="Repair the takes, or name another folder of recordings",
        )
    usable = tuple(take for take in takes.takes if take.name in found)
    return _prepared(usable, found, names, frame_rate, skipped)


def _in_turn(takes: tuple[Take, ...], cache: Path) -> Iterator[Take]:
    """Yield each take while no other process works on it; those in work elsewhere come last."""
    busy: list[Take] = []
    for take in takes:
        with _alone(cache / take.name, wait=False) as alone:
            if alone:
                yield take
            else:
                busy.append(take)
    for take in busy:
        with _alone(cache / take.name, wait=True):
            yield take


@contextmanager
def _alone(folder: Path, *, wait: bool) -> Iterator[bool]:
    """Keep other processes from working on a take; gives whether that was possible."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            yield False
        else:
            yield True


def _all_kept(
    take: Take, features: Sequence[Feature], frame_rate: float, folder: Path
) -> dict[str, KeptArray]:
    """Return the features of a take from `folder`, where they are put if they are not there."""
    files = hashes_of(take.files, folder / "files.json")
    optional = ("face", "semantic", "transcript")
    roles = [role for role in optional if getattr(take, role) is not None]
    kept: dict[str, KeptArray] = {}
    for feature in features:
        key = content_sha256(
            [json.dumps([files, roles, feature.name, feature.version, frame_rate])]
        )
        kept[feature.name] = _kept(take, feature, folder / f"{feature.name}-{key[:32]}.npy")
        # As early as can be told: the next feature may take long.
        _check_lengths(take, kept, frame_rate)
    return kept


def _kept(take: Take, feature: Feature, path: Path) -> KeptArray:
    kept = open_array(path)
    if kept is None:
        write_array(path, _computed(take, feature))
        kept = open_array(path)
    if kept is None:
        raise OSError(errno.EIO, "what was written cannot be read", str(path))
    return kept


def _computed(take: Take, feature: Feature) -> FloatArray:
    values = np.ascontiguousarray(feature.compute(take), dtype=np.float32)
    if values.ndim != 2 or not values.size:
        raise InputError(
            f"its {feature.name} has shape {values.shape}",
            remedy="Give a take that lasts at least one frame",
        )
    if not np.isfinite(values).all():
        frame, channel = map(int, np.argwhere(~np.isfinite(values))[0])
        raise InputError(
            f"its {feature.name} is not a number at frame {frame}, channel {channel}",
            remedy="Repair or cut the recording",
        )
    return values


def _check_lengths(take: Take, kept: Mapping[str, KeptArray], frame_rate: float) -> None:
    """Raise where the features of a take differ in length by more than is ordinary."""
    seconds = {name: len(array.values) / frame_rate for name, array in kept.items()}
    shortest = min(seconds, key=lambda name: seconds[name])
    longest = max(seconds, key=lambda name: seconds[name])
    if seconds[longest] - seconds[shortest] > LONGEST_DIFFERENCE:
        raise InputError(
            f"{longest} lasts {seconds[longest]:.2f} s and {shortest} {seconds[shortest]:.2f} s, "
            f"more than {LONGEST_DIFFERENCE:g} s apart",
            where=take.motion,
            remedy="Give sound and motion of the same recording, from the same moment on",
        )


def _named(take: Take, error: InputError) -> InputError:
    """Return `error` with the name of its take."""
    return InputError(
        f"take {take.name}: {error.what}", where=error.where or take.motion, remedy=error.remedy
    )


def _prepared(
    takes: tuple[Take, ...],
    found: Mapping[str, Mapping[str, KeptArray]],
    names: list[str],
    frame_rate: float,
    skipped: tuple[InputError, ...],
) -> PreparedTakes:
    """Return the takes with their features cut to the same length."""
    arrays: dict[str, list[FloatArray]] = {name: [] for name in names}
    facts = [f"{frame_rate!r}"]
    for take in takes:
        kept = found[take.name]
        frames = min(len(array.values) for array in kept.values())
        facts.append(json.dumps([take.name, take.split, take.speaker, take.emotion, frames]))
        for name in names:
            arrays[name].append(kept[name].values[:frames])
            facts.append(f"{name} {kept[name].sha256}")
    return PreparedTakes(
        takes=takes,
        arrays={name: tuple(values) for name, values in arrays.items()},
        frame_rate=frame_rate,
        skipped=skipped,
        sha256=content_sha256(facts),
    )
