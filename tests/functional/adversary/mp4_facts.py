"""What an MP4 file tells beside the pictures and the sound that are encoded in it."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from typing import Final

Facts = dict[str, float | str]
"""Numbers by name, and texts that are only alike or not."""

HOLDERS: Final = {"moov", "trak", "mdia", "minf", "stbl", "edts", "dinf", "udta"}
"""Boxes that hold nothing but boxes (ISO/IEC 14496-12)."""

COUNTED: Final = {"stsz": 12, "stco": 8}
"""Tables of how many bytes each encoded picture and each stretch of sound has, and where it lies.
They follow from what is seen and heard; how many there are does not, and stands before them."""

SHORT: Final = 256
"""Bytes of a box whose content is also read as numbers."""

TEXT: Final = re.compile(rb"[\x20-\x7e]{16,}")
"""What somebody wrote into a file; encoded pictures hold so long a run by chance but rarely."""


@lru_cache(maxsize=4096)
def facts_of(video: bytes) -> Facts:
    """Return what the boxes of `video` tell.

    Left out is what follows from the encoded pictures and sound alone: these themselves, the
    bytes each of them has, and the padding that makes up for their sum.
    """
    facts: Facts = {}
    counts: Counter[str] = Counter()
    for name, content in _boxes(video, 0, len(video), ""):
        counts[name] += 1
        key = f"{name}{counts[name]}"
        if name in ("/mdat", "/free"):
            continue
        described = content[: COUNTED.get(name.rpartition("/")[2], len(content))]
        facts[f"{key} bytes"] = len(content)
        facts[f"{key} content"] = hashlib.sha256(described).hexdigest()
        if len(described) <= SHORT:
            for at in range(0, len(described) - 3, 4):
                facts[f"{key} at {at}"] = int.from_bytes(described[at : at + 4], "big")
    order = [name for name, _ in _boxes(video, 0, len(video), "")]
    facts["order"] = " ".join(order[:-1] if order[-1] == "/free" else order)
    for text in TEXT.findall(video):
        facts[f"text {text.decode()}"] = 1
    return facts


def _boxes(data: bytes, start: int, stop: int, inside: str) -> Iterator[tuple[str, bytes]]:
    """Yield the way to each box that holds no others, and its content."""
    while start + 8 <= stop:
        size = int.from_bytes(data[start : start + 4], "big")
        kind = data[start + 4 : start + 8].decode("latin-1")
        assert size >= 8, f"a broken box {kind!r} at byte {start}"
        if kind in HOLDERS:
            yield from _boxes(data, start + 8, start + size, f"{inside}/{kind}")
        else:
            yield f"{inside}/{kind}", data[start + 8 : start + size]
        start += size
