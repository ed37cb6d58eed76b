"""Features of many takes, computed once and cached on disk."""

import fcntl
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow

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
        Hash of the takes' names, splits, speakers and emotions, of their files and of the features'
        versions.
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
    The call may be interrupted and repeated. Several processes may call it at once; each feature is
    computed by one of them. Everything in `cache` may be removed between calls.

    Parameters
    ----------
    takes : TakeFolder
        The takes.
    features : sequence of Feature
        At least one feature; names must differ.
    cache : Path
        Folder of the cache, with a folder for each take and a file for each feature.
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
    usable: list[Take] = []
    arrays: dict[str, list[Floats32]] = {feature.name: [] for feature in features}
    facts: list[object] = [frame_rate]
    skipped = [*takes.skipped]
    try:
        for number, take in enumerate(takes.takes, start=1):
            try:
                with _locked(cache / take.name) as folder:
                    paths = _feature_paths(take, features, frame_rate, folder)
                    values = _cached_features(take, features, frame_rate, paths)
            except InputError as error:
                skipped.append(_with_take_name(take, error))
            else:
                usable.append(take)
                facts.append([take.name, take.split, take.speaker, take.emotion])
                facts += [path.name for path in paths]
                for feature, of_take in zip(features, values, strict=True):
                    arrays[feature.name].append(of_take)
            if show:
                show(number, len(takes.takes), take.name)
    except OSError as error:
        raise InputError(
            f"features cannot be stored ({error.strerror or error})",
            where=cache,
            remedy="Free space there, or name another folder for them",
        ) from error
    if not usable:
        raise InputError(
            f"none of the {len(takes.takes)} takes can be used"
            + (f"; the first: {skipped[0]}" if skipped else ""),
            where=cache,
            remedy="Repair the takes, or name another folder of recordings",
        )
    return PreparedTakes(
        takes=tuple(usable),
        arrays={name: tuple(values) for name, values in arrays.items()},
        frame_rate=frame_rate,
        skipped=tuple(skipped),
        sha256=_content_sha256(facts),
    )


@contextmanager
def _locked(folder: Path) -> Iterator[Path]:
    """Hold the lock of a take's folder, which is made if it is missing."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


def _feature_paths(
    take: Take, features: Sequence[Feature], frame_rate: float, folder: Path
) -> list[Path]:
    """Return the files of a take's features; their names have a hash of all that they depend on."""
    files = _hashes_of(take.files, folder / "files.json")
    optional = ("face", "semantic", "transcript")
    roles = [role for role in optional if getattr(take, role) is not None]
    keys = [
        _content_sha256([files, roles, feature.name, feature.version, frame_rate])
        for feature in features
    ]
    return [
        folder / f"{feature.name}-{key[:32]}.tensor"
        for feature, key in zip(features, keys, strict=True)
    ]


def _cached_features(
    take: Take, features: Sequence[Feature], frame_rate: float, paths: Sequence[Path]
) -> list[Floats32]:
    """Return the features of a take, of equal length; compute those that have no file yet."""
    arrays: list[Floats32] = []
    for feature, path in zip(features, paths, strict=True):
        if not path.exists():
            _write_array(path, _compute(take, feature))
        arrays.append(_map_array(path))
        # As early as possible: the next feature may take long to compute.
        _check_lengths(take, features, arrays, frame_rate)
    frames = min(map(len, arrays))
    return [values[:frames] for values in arrays]


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


def _check_lengths(
    take: Take, features: Sequence[Feature], arrays: Sequence[Floats32], frame_rate: float
) -> None:
    """Raise if the features of a take differ too much in length."""
    lengths = [
        (len(values) / frame_rate, feature.name)
        for values, feature in zip(arrays, features, strict=False)
    ]
    (shortest, shorter), (longest, longer) = min(lengths), max(lengths)
    if longest - shortest > LONGEST_DIFFERENCE:
        raise InputError(
            f"{longer} lasts {longest:.2f} s and {shorter} {shortest:.2f} s, "
            f"more than {LONGEST_DIFFERENCE:g} s apart",
            where=take.motion,
            remedy="Give sound and motion of the same recording, from the same moment on",
        )


def _with_take_name(take: Take, error: InputError) -> InputError:
    """Return `error` with the take's name in it."""
    return InputError(
        f"take {take.name}: {error.what}", where=error.where or take.motion, remedy=error.remedy
    )


def _hashes_of(files: tuple[Path, ...], memory: Path) -> list[str]:
    """Return the SHA-256 of each of `files`; those of unchanged files are read from `memory`.

    A copy or an edit can keep the modification time (mtime), but not the change time (ctime).
    """
    known = json.loads(memory.read_text("utf-8")) if memory.exists() else {}
    hashes: dict[str, str] = {}
    for path in files:
        try:
            status = path.stat()
            times = f"{status.st_mtime_ns} {status.st_ctime_ns}"
            state = f"{path.absolute()} {status.st_size} {times}"
            hashes[state] = known.get(state) or sha256_of(path)
        except OSError as error:
            raise InputError(
                f"the file cannot be read ({error.strerror})",
                where=path,
                remedy="Check that it is there and may be read",
            ) from error
    if hashes != known:
        write_text(memory, json.dumps(hashes, indent=1))
    return list(hashes.values())


def _write_array(path: Path, values: Floats32) -> None:
    with replacing(path) as draft, pyarrow.OSFile(str(draft), "wb") as file:
        pyarrow.ipc.write_tensor(pyarrow.Tensor.from_numpy(values), file)


def _map_array(path: Path) -> Floats32:
    """Return the array in `path`, mapped into memory.

    numpy's own mapping keeps each file open, and a data set has more files than a process may open.
    """
    try:
        with pyarrow.memory_map(str(path)) as mapped:
            values: Floats32 = pyarrow.ipc.read_tensor(mapped).to_numpy()
            return values
    except (OSError, ValueError) as error:
        raise InputError(
            "the cached feature cannot be read", where=path, remedy="Delete the file"
        ) from error


def _content_sha256(facts: Sequence[object]) -> str:
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()
