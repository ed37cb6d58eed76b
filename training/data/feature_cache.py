"""Features of many takes, computed once and cached on disk."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow
from pydantic import BaseModel, TypeAdapter, ValidationError

from motion.arrays import Floats32
from motion.errors import InputError
from motion.files import replacing, sha256_of, write_text
from training.data.take import LONGEST_DIFFERENCE, Feature, Take, TakeFolder

Show = Callable[[int, int, str], None]
"""Called with the number of finished takes, the number of all takes, and the last one's name."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PreparedTakes:
    """Takes whose features can be read.

    Attributes
    ----------
    takes : tuple of Take
        Takes in order of their names.
    arrays : mapping of str to tuple of ndarray
        Values of each feature for each take, (frames, channels) float32, memory-mapped. All
        features of a take have the same frames.
    frame_rate : float
        Frames per second.
    skipped : tuple of InputError
        Why takes could not be used; those of the folder come first.
    sha256 : str
        Hash of the takes' names, splits, speakers, emotions and features.
    """

    takes: tuple[Take, ...]
    arrays: Mapping[str, tuple[Floats32, ...]]
    frame_rate: float
    skipped: tuple[InputError, ...]
    sha256: str

    def frames(self, index: int) -> int:
        """Return the number of frames of take `index`."""
        return len(next(iter(self.arrays.values()))[index])

    def training_speakers(self, speakers: Sequence[str]) -> tuple[str, ...]:
        """Return the `speakers` who have takes in the training split, in the same order."""
        trained = {take.speaker for take in self.takes if take.split == "train"}
        return tuple(name for name in speakers if name in trained)

    def mean_first(self, feature: str) -> Floats32:
        """Return the mean first frame (channels,) of a feature over the training split."""
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
    """Compute features of all takes, or read them from the cache.

    A cached feature was computed by the same version of the feature from files of the same content.
    The call may be interrupted and repeated. Several processes may call it at once; they share the
    work. Everything in `cache` may be removed between calls.

    Parameters
    ----------
    takes : TakeFolder
        The takes.
    features : sequence of Feature
        At least one feature; names must differ.
    cache : Path
        Folder of the cache, with a folder for each take and a ``.npy`` for each feature.
    frame_rate : float
        Frames per second of all features.
    show : callable, optional
        Called with the progress.

    Returns
    -------
    PreparedTakes
        A take is skipped if a feature cannot be computed or is not finite, or if its features
        differ in length by more than `LONGEST_DIFFERENCE`. Features are cut to the shortest.

    Raises
    ------
    InputError
        If no take can be used, or the cache cannot be written.
    """
    arrays: dict[str, dict[str, _CachedArray]] = {}
    errors: dict[str, InputError] = {}
    try:
        for take in _locked_takes(takes.takes, cache):
            try:
                arrays[take.name] = _cached_features(take, features, frame_rate, cache / take.name)
            except InputError as error:
                errors[take.name] = _with_take_name(take, error)
            if show:
                show(len(arrays) + len(errors), len(takes.takes), take.name)
    except OSError as error:
        raise InputError(
            f"features cannot be stored ({error.strerror or error})",
            where=cache,
            remedy="Free space there, or name another folder for them",
        ) from error
    skipped = (*takes.skipped, *(errors[name] for name in sorted(errors)))
    if not arrays:
        raise InputError(
            f"none of the {len(takes.takes)} takes can be used"
            + (f"; the first: {skipped[0]}" if skipped else ""),
            where=cache,
            remedy="Repair the takes, or name another folder of recordings",
        )
    usable = tuple(take for take in takes.takes if take.name in arrays)
    return _trimmed(usable, arrays, [feature.name for feature in features], frame_rate, skipped)


def _locked_takes(takes: tuple[Take, ...], cache: Path) -> Iterator[Take]:
    """Yield each take under a lock; takes locked by another process come last."""
    busy: list[Take] = []
    for take in takes:
        with _take_lock(cache / take.name, wait=False) as locked:
            if locked:
                yield take
            else:
                busy.append(take)
    for take in busy:
        with _take_lock(cache / take.name, wait=True):
            yield take


@contextmanager
def _take_lock(folder: Path, *, wait: bool) -> Iterator[bool]:
    """Hold the lock of a take; yield whether it was acquired."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            yield False
        else:
            yield True


def _cached_features(
    take: Take, features: Sequence[Feature], frame_rate: float, folder: Path
) -> dict[str, _CachedArray]:
    """Return the features of a take; compute those that are not in `folder` yet."""
    files = _hashes_of(take.files, folder / "files.json")
    optional = ("face", "semantic", "transcript")
    roles = [role for role in optional if getattr(take, role) is not None]
    cached: dict[str, _CachedArray] = {}
    for feature in features:
        key = _content_sha256(
            [json.dumps([files, roles, feature.name, feature.version, frame_rate])]
        )
        cached[feature.name] = _cached(take, feature, folder / f"{feature.name}-{key[:32]}.npy")
        # As early as possible: the next feature may take long to compute.
        _check_lengths(take, cached, frame_rate)
    return cached


def _cached(take: Take, feature: Feature, path: Path) -> _CachedArray:
    cached = _open_array(path)
    if cached is None:
        _write_array(path, _compute(take, feature))
        cached = _open_array(path)
    if cached is None:
        raise OSError(errno.EIO, "the written file cannot be read", str(path))
    return cached


def _compute(take: Take, feature: Feature) -> Floats32:
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


def _check_lengths(take: Take, cached: Mapping[str, _CachedArray], frame_rate: float) -> None:
    """Raise if the features of a take differ too much in length."""
    seconds = {name: len(array.values) / frame_rate for name, array in cached.items()}
    shortest = min(seconds, key=lambda name: seconds[name])
    longest = max(seconds, key=lambda name: seconds[name])
    if seconds[longest] - seconds[shortest] > LONGEST_DIFFERENCE:
        raise InputError(
            f"{longest} lasts {seconds[longest]:.2f} s and {shortest} {seconds[shortest]:.2f} s, "
            f"more than {LONGEST_DIFFERENCE:g} s apart",
            where=take.motion,
            remedy="Give sound and motion of the same recording, from the same moment on",
        )


def _with_take_name(take: Take, error: InputError) -> InputError:
    """Return `error` with the take's name in it."""
    return InputError(
        f"take {take.name}: {error.what}", where=error.where or take.motion, remedy=error.remedy
    )


def _trimmed(
    takes: tuple[Take, ...],
    cached: Mapping[str, Mapping[str, _CachedArray]],
    names: list[str],
    frame_rate: float,
    skipped: tuple[InputError, ...],
) -> PreparedTakes:
    """Return the takes with their features cut to the same length."""
    arrays: dict[str, list[Floats32]] = {name: [] for name in names}
    facts = [f"{frame_rate!r}"]
    for take in takes:
        features = cached[take.name]
        frames = min(len(array.values) for array in features.values())
        facts.append(json.dumps([take.name, take.split, take.speaker, take.emotion, frames]))
        for name in names:
            arrays[name].append(features[name].values[:frames])
            facts.append(f"{name} {features[name].sha256}")
    return PreparedTakes(
        takes=takes,
        arrays={name: tuple(values) for name, values in arrays.items()},
        frame_rate=frame_rate,
        skipped=skipped,
        sha256=_content_sha256(facts),
    )


class _FileState(BaseModel, frozen=True):
    """The hash of a file; its size and times show whether it is still valid.

    A copy or an edit can keep the modification time (mtime), but not the change time (ctime).
    """

    size: int
    mtime_ns: int
    ctime_ns: int = 0
    sha256: str


_STATES: Final = TypeAdapter(dict[str, _FileState])


def _state_of(path: Path, known: _FileState | None = None) -> _FileState:
    """Return the state of `path`; it is read only if size or times differ from `known`."""
    status = path.stat()
    state = _FileState(
        size=status.st_size,
        mtime_ns=status.st_mtime_ns,
        ctime_ns=status.st_ctime_ns,
        sha256="" if known is None else known.sha256,
    )
    return state if state == known else state.model_copy(update={"sha256": sha256_of(path)})


def _hashes_of(files: tuple[Path, ...], memory: Path) -> tuple[str, ...]:
    """Return the SHA-256 of each of `files`.

    The file `memory` has the hashes of earlier calls; it may be missing or damaged.
    """
    try:
        known = _STATES.validate_json(memory.read_bytes())
    except (OSError, ValidationError):
        known = {}
    states: dict[str, _FileState] = {}
    for path in files:
        place = str(path.absolute())
        try:
            states[place] = _state_of(path, known.get(place))
        except OSError as error:
            raise InputError(
                f"the file cannot be read ({error.strerror})",
                where=path,
                remedy="Check that it is there and may be read",
            ) from error
    if states != known:
        write_text(memory, _STATES.dump_json(states, indent=1).decode())
    return tuple(states[str(path.absolute())].sha256 for path in files)


@dataclass(frozen=True, eq=False)
class _CachedArray:
    """An array (frames, channels), memory-mapped and read-only, and the hash of its file."""

    values: Floats32
    sha256: str


def _write_array(path: Path, values: Floats32) -> None:
    """Write `values` to `path` (``.npy``), and next to it a seal that proves it intact."""
    with replacing(path) as draft:
        np.save(draft, values, allow_pickle=False)
    write_text(path.with_suffix(".json"), _state_of(path).model_dump_json())


def _open_array(path: Path) -> _CachedArray | None:
    """Return the array in `path`; None if it is missing or damaged."""
    seal_path = path.with_suffix(".json")
    try:
        seal = _FileState.model_validate_json(seal_path.read_bytes())
        state = _state_of(path, seal)
        if state.sha256 != seal.sha256:
            return None
        if state != seal:
            # A copy has the same content but another time. It need not be read again.
            write_text(seal_path, state.model_dump_json())
        return _CachedArray(_map_array(path), state.sha256)
    except (OSError, ValidationError, ValueError):
        return None


def _map_array(path: Path) -> Floats32:
    """Return the array in `path`, mapped into memory.

    numpy's own mapping keeps each file open, and a data set has more files than a process may open.
    """
    with path.open("rb") as file:
        version = np.lib.format.read_magic(file)
        if version != (1, 0):
            raise ValueError(f"version {version} of the file format")
        shape, fortran_order, dtype = np.lib.format.read_array_header_1_0(file)
        start = file.tell()
    if fortran_order or dtype != np.float32 or len(shape) != 2:
        raise ValueError("not an array that this module wrote")
    with pyarrow.memory_map(str(path)) as mapped:
        buffer = mapped.read_buffer()
    values = np.frombuffer(buffer, dtype=np.float32, offset=start)
    return values.reshape(shape)


def _content_sha256(parts: list[str]) -> str:
    """Return one hash of several texts in order."""
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
