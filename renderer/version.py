"""Versions of what is drawn; whatever was made with another version is made anew.

Raise a version with every change that can be seen or heard; tests hold what each version gives.
"""

from __future__ import annotations

from typing import Final

RENDERER_VERSION: Final = "2"
"""Of the pixels and the sound of clips, pairs and dubbed videos, avatars' bodies among them."""

COPY_VERSION: Final = "1"
"""Of copies for participants."""

CELL_VERSION: Final = "1"
"""Of the cells of contact sheets."""
