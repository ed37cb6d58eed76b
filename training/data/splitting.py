"""Splits of recordings: by a list, by the data set's own rule, or by hash.

Windows of one recording resemble each other, so a recording is held out as a whole.
"""

from __future__ import annotations

import csv
import hashlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from pydantic import TypeAdapter, ValidationError

from motion.endings import MOTION_ENDINGS, SPEECH_ENDINGS
from motion.errors import InputError, counted, listed
from training.data.found_take import SPLIT_WORDS, Findings
from training.data.take import SPLITS, Split, Take

USUAL_NAMES: Final = ("splits.csv", "train_test_split.csv", "train_val_test.json")
"""Names under which a folder's own list is found; the last two are BEAT2's and TalkSHOW's."""

_NAME_COLUMNS: Final = ("name", "id")
_SPLIT_COLUMNS: Final = ("split", "type")
_ENDINGS: Final = (*MOTION_ENDINGS, *SPEECH_ENDINGS, ".json", ".pkl")
_FORMS: Final = (
    "Give a CSV with the columns name and split, or JSON with lists of names under train, "
    "validation and test"
)
_BY_SPLIT: Final = TypeAdapter(dict[str, list[str]])


@dataclass(frozen=True, kw_only=True)
class SplitList:
    """The splits of takes.

    Attributes
    ----------
    path : Path
        File of the list.
    splits : mapping of str to split
        Split of each name.
    others : mapping of str to str
        Split of each name in a split of another kind, such as BEAT2's ``additional``.
    """

    path: Path
    splits: Mapping[str, Split]
    others: Mapping[str, str]


def read_split_list(path: Path) -> SplitList:
    """Read a split list.

    Parameters
    ----------
    path : Path
        CSV with a column of names (``name`` or ``id``) and one of splits (``split`` or ``type``),
        or JSON of lists of names by split. Names may include a file ending. Splits may be called
        train, val, dev, test, ….

    Raises
    ------
    InputError
        If it is neither, names no split, or puts a name into two splits.
    """
    splits: dict[str, Split] = {}
    others: dict[str, str] = {}
    for name, word, where in _rows(path):
        name = without_ending(name)
        split = SPLIT_WORDS.get(word.lower())
        previous = splits.get(name) or others.get(name)
        if previous is not None and previous != (split or word):
            raise InputError(
                f"{name!r} is in {previous} and in {split or word}",
                where=where,
                remedy="Keep each take in one split",
            )
        if split:
            splits[name] = split
        else:
            others[name] = word
    if not splits:
        raise InputError("the split list names no split", where=path, remedy=_FORMS)
    return SplitList(path=path, splits=splits, others=others)


def without_ending(name: str) -> str:
    """Return the name of a take without a file ending, with ``/`` between folders."""
    name = name.strip().replace("\\", "/").removeprefix("./")
    ending = next((ending for ending in _ENDINGS if name.lower().endswith(ending)), "")
    return name[: len(name) - len(ending)]


def _rows(path: Path) -> Iterator[tuple[str, str, str]]:
    """Yield name, split and position in the list."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("the split list cannot be read", where=path, remedy=_FORMS) from error
    if path.suffix.lower() == ".json":
        yield from _json_rows(text, path)
    else:
        yield from _csv_rows(text, path)


def _json_rows(text: str, path: Path) -> Iterator[tuple[str, str, str]]:
    try:
        for word, names in _BY_SPLIT.validate_json(text).items():
            yield from ((name, word, str(path)) for name in names)
    except ValidationError as error:
        raise InputError(
            f"the split list is not JSON of names by split ({str(error).splitlines()[0]})",
            where=path,
            remedy=_FORMS,
        ) from error


def _csv_rows(text: str, path: Path) -> Iterator[tuple[str, str, str]]:
    rows = [
        ([cell.strip() for cell in row], f"{path}, line {line}")
        for line, row in enumerate(csv.reader(text.splitlines()), start=1)
        if any(cell.strip() for cell in row)
    ]
    if not rows:
        raise InputError("the split list is empty", where=path, remedy=_FORMS)
    header = [cell.lower() for cell in rows[0][0]]
    name_at = next((header.index(name) for name in _NAME_COLUMNS if name in header), None)
    split_at = next((header.index(name) for name in _SPLIT_COLUMNS if name in header), None)
    if name_at is None or split_at is None:
        raise InputError(
            f"the split list has the columns {', '.join(header)}", where=path, remedy=_FORMS
        )
    for row, where in rows[1:]:
        if len(row) <= max(name_at, split_at) or not row[name_at] or not row[split_at]:
            raise InputError(
                "the row has no name or no split", where=where, remedy="Complete or remove it"
            )
        yield row[name_at], row[split_at], where


HELD_OUT_SHARE: Final = 0.1
"""Share of the recordings held out for validation, and for testing, by default."""

_QUOTED_NAMES: Final = 3
"""Number of names that a note quotes."""


def by_list(findings: Findings, splits: SplitList) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return the takes that a list names, with their splits, and notes about the others.

    A list may use the take's name, its file's name, or its path below the folder.

    Raises
    ------
    InputError
        If the list names none of the takes.
    """
    takes: list[Take] = []
    unlisted: list[str] = []
    elsewhere: Counter[str] = Counter()
    known_names: set[str] = set()
    for item in findings.takes:
        names = (item.take.name, item.take.motion.stem, item.place)
        split = next((splits.splits[name] for name in names if name in splits.splits), None)
        known_names.update(names)
        if split is not None:
            takes.append(replace(item.take, split=split))
        elif other := next((splits.others[name] for name in names if name in splits.others), None):
            elsewhere[other] += 1
        else:
            unlisted.append(item.take.name)
    if not takes:
        raise InputError(
            f"the split list names none of the {len(findings.takes)} takes, of which the first is "
            f"{findings.takes[0].take.name}",
            where=splits.path,
            remedy="Name takes after their files",
        )
    missing = sorted(name for name in (*splits.splits, *splits.others) if name not in known_names)
    notes = [f"splits by {splits.path.name}: {count_splits(takes)}"]
    if unlisted:
        notes.append(f"{_quote_names(unlisted, 'take')} left out, which the list does not name")
    notes += [f"{counted(number, 'take')} left out as {word}" for word, number in elsewhere.items()]
    if missing:
        notes.append(f"{_quote_names(missing, 'name')} of the list not found")
    return tuple(takes), tuple(notes)


def by_rule(findings: Findings) -> tuple[tuple[Take, ...], tuple[str, ...]]:
    """Return all takes with the data set's own split, or one by hash.

    A take without a split gets that of other takes of its recording. Recordings without a split are
    sorted by the hash of their name: the first tenth is for testing and the next for validation, at
    least one each if there are three or more.
    """
    given: dict[str, list[Split]] = {}
    for item in sorted(findings.takes, key=lambda item: item.take.name):
        if item.given_split:
            given.setdefault(item.recording, []).append(item.given_split)
    hashed = split_by_hash({item.recording for item in findings.takes} - set(given))
    ruled: list[Take] = []
    by_hash: list[Take] = []
    for item in findings.takes:
        if item.recording in given:
            ruled.append(replace(item.take, split=item.given_split or given[item.recording][0]))
        else:
            by_hash.append(replace(item.take, split=hashed[item.recording]))
    divided = sum(len(set(splits)) > 1 for splits in given.values())
    notes = []
    if ruled:
        notes.append(f"splits by {findings.split_rule}: {count_splits(ruled)}")
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
