"""Splits of recordings: by a list, by the data set's own rule, or by hash.

Windows of one recording resemble each other, so a recording is held out as a whole.
"""

import csv
import hashlib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from pydantic import TypeAdapter

from motion.endings import MOTION_ENDINGS, SPEECH_ENDINGS
from motion.errors import InputError, counted, listed
from training.data.found_take import SPLIT_WORDS, FoundTake
from training.data.take import SPLITS, Split, Take

USUAL_NAMES: Final = ("splits.csv", "train_test_split.csv", "train_val_test.json")
"""Names under which a folder's own list is found; the last two are BEAT2's and TalkSHOW's."""

_NAME_COLUMNS: Final = ("name", "id")
_SPLIT_COLUMNS: Final = ("split", "type")
_ENDINGS: Final = (*MOTION_ENDINGS, *SPEECH_ENDINGS, ".json", ".pkl")
_BY_SPLIT: Final = TypeAdapter(dict[str, list[str]])


def read_split_list(path: Path) -> Mapping[str, Split | None]:
    """Return the split of each name in a list; None if it is none of ours, as ``additional``.

    Parameters
    ----------
    path : Path
        CSV with a column of names (``name`` or ``id``) and one of splits (``split`` or ``type``),
        or JSON of lists of names by split. Names may include a file ending. Splits may be called
        train, val, dev, test, ….

    Raises
    ------
    InputError
        If it is neither, or puts a name into two splits.
    """
    splits: dict[str, Split | None] = {}
    try:
        text = path.read_text(encoding="utf-8-sig")
        rows = _json_rows(text) if path.suffix.lower() == ".json" else _csv_rows(text)
    except (OSError, ValueError) as error:
        problem = str(error).partition("\n")[0]
        raise InputError(
            f"the split list cannot be read ({problem})",
            where=path,
            remedy="Give a CSV with the columns name and split, or JSON with lists of names under "
            "train, validation and test",
        ) from error
    for name, word in rows:
        name, split = _without_ending(name), SPLIT_WORDS.get(word.strip().lower())
        if splits.setdefault(name, split) != split:
            raise InputError(
                f"{name!r} is in two splits", where=path, remedy="Keep each take in one split"
            )
    return splits


def _json_rows(text: str) -> list[tuple[str, str]]:
    by_split = _BY_SPLIT.validate_json(text)
    return [(name, word) for word, names in by_split.items() for name in names]


def _csv_rows(text: str) -> list[tuple[str, str]]:
    table = csv.DictReader(text.splitlines())
    header = {name.strip().lower(): name for name in table.fieldnames or ()}
    columns = [
        next((header[name] for name in names if name in header), None)
        for names in (_NAME_COLUMNS, _SPLIT_COLUMNS)
    ]
    if None in columns:
        raise ValueError(f"it has the columns {', '.join(header)}")
    rows = [[row[column] or "" for column in columns if column is not None] for row in table]
    return [(name, word) for name, word in rows]


def _without_ending(name: str) -> str:
    """Return the name of a take without a file ending, with ``/`` between folders."""
    name = name.strip().replace("\\", "/").removeprefix("./")
    ending = next((ending for ending in _ENDINGS if name.lower().endswith(ending)), "")
    return name[: len(name) - len(ending)]


HELD_OUT_SHARE: Final = 0.1
"""Share of the recordings held out for validation, and for testing, by default."""

_QUOTED_NAMES: Final = 3
"""Number of names that a note quotes."""


def by_list(
    found: Sequence[FoundTake], splits: Mapping[str, Split | None], path: Path
) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return the takes that a list names, with their splits, and notes about the others.

    A list may use the take's name, its file's name, or its path below the folder.

    Raises
    ------
    InputError
        If the list in `path` gives a split to none of the takes.
    """
    takes: list[Take] = []
    left_out: list[str] = []
    known_names: set[str] = set()
    for item in found:
        names = (item.take.name, item.take.motion.stem, item.place)
        split = next((splits[name] for name in names if name in splits), None)
        known_names.update(names)
        if split is None:
            left_out.append(item.take.name)
        else:
            takes.append(replace(item.take, split=split))
    if not takes:
        raise InputError(
            f"the split list names none of the {len(found)} takes, of which the first is "
            f"{found[0].take.name}",
            where=path,
            remedy="Name takes after their files",
        )
    notes = [f"splits by {path.name}: {count_splits(takes)}"]
    if left_out:
        notes.append(f"{_quote_names(left_out, 'take')} left out, to which the list gives no split")
    missing = sorted(splits.keys() - known_names)
    if missing:
        notes.append(f"{_quote_names(missing, 'name')} of the list not found")
    return tuple(takes), tuple(notes)


def by_rule(found: Sequence[FoundTake], rule: str) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return all takes with the data set's own split, or one by hash.

    A take without a split gets that of other takes of its recording. Recordings without a split are
    sorted by the hash of their name: the first tenth is for testing and the next for validation, at
    least one each if there are three or more.

    Parameters
    ----------
    found : sequence of FoundTake
        The takes.
    rule : str
        The source of `FoundTake.given_split`, in words.
    """
    given: dict[str, list[Split]] = {}
    for item in sorted(found, key=lambda item: item.take.name):
        if item.given_split:
            given.setdefault(item.recording, []).append(item.given_split)
    hashed = split_by_hash({item.recording for item in found} - set(given))
    ruled: list[Take] = []
    by_hash: list[Take] = []
    for item in found:
        if item.recording in given:
            ruled.append(replace(item.take, split=item.given_split or given[item.recording][0]))
        else:
            by_hash.append(replace(item.take, split=hashed[item.recording]))
    divided = sum(len(set(splits)) > 1 for splits in given.values())
    notes = []
    if ruled:
        notes.append(f"splits by {rule}: {count_splits(ruled)}")
    if divided:
        notes.append(
            f"{counted(divided, 'recording')} cut into takes of several splits, so held-out takes "
            "resemble training takes"
        )
    if by_hash:
        notes.append(f"splits by the hash of each recording's name: {count_splits(by_hash)}")
    return (*ruled, *by_hash), tuple(notes)


def split_by_hash(recordings: Iterable[str]) -> dict[str, Split]:
    """Return a split for each recording that depends only on the set of names."""
    order = sorted(recordings, key=lambda name: hashlib.sha256(name.encode()).digest())
    count = max(round(HELD_OUT_SHARE * len(order)), 1 if len(order) > 2 else 0)
    splits: dict[str, Split] = dict.fromkeys(order, "train")
    splits.update(dict.fromkeys(order[:count], "test"))
    splits.update(dict.fromkeys(order[count : 2 * count], "validation"))
    return splits


def count_splits(takes: Sequence[Take]) -> str:
    """Return the number of takes in each split, in words."""
    takes_of_split = Counter(take.split for take in takes)
    return listed([f"{takes_of_split[split]} {split}" for split in SPLITS])


def _quote_names(names: Sequence[str], noun: str) -> str:
    """Return ``12 takes (a, b, c, …)``."""
    quoted = ", ".join(names[:_QUOTED_NAMES])
    return f"{counted(len(names), noun)} ({quoted}{', …' if len(names) > _QUOTED_NAMES else ''})"


def held_out_recordings(
    recordings: Sequence[str], labels: Sequence[str], *, share: float, seed: int
) -> frozenset[str]:
    """Return the names of the recordings to hold out.

    Parameters
    ----------
    recordings : sequence of str
        The recording of each clip.
    labels : sequence of str
        The label of each clip; the same for all if there are none. Each label keeps at least one
        recording for training.
    share : float
        Share of each label's recordings, above 0 and below 1; at least one if there are two.
    seed : int
        Random seed, at least 0.

    Returns
    -------
    frozenset of str
        Empty if no label has two recordings.
    """
    label_counts: dict[str, Counter[str]] = {}
    for recording, label in zip(recordings, labels, strict=True):
        label_counts.setdefault(recording, Counter())[label] += 1
    by_label: dict[str, list[str]] = {}
    for recording in sorted(label_counts):
        counts = label_counts[recording]
        main_label = max(sorted(counts), key=lambda label: counts[label])
        by_label.setdefault(main_label, []).append(recording)
    chance = np.random.default_rng(seed)
    held_out: list[str] = []
    for label in sorted(by_label):
        names = by_label[label]
        count = min(len(names) - 1, max(1, round(share * len(names))))
        chosen = chance.permutation(len(names))[: max(0, count)]
        held_out += [names[index] for index in chosen]
    return frozenset(held_out)
