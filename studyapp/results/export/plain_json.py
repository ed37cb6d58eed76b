"""JSON as files hold it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def as_json(content: Mapping[str, Any]) -> str:
    """Return `content` as the text of a JSON file; a number that is none is an error."""
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
