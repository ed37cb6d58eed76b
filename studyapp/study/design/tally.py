"""What has been preferred so far, pair by pair."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

Tally = Mapping[tuple[str, str], float]
"""How often the first condition was preferred to the second; a tie is half a win for both."""

NO_VOTES: Final[Tally] = MappingProxyType({})
