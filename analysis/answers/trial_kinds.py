"""Which trials are analysed."""

from __future__ import annotations

from typing import Final

ANALYSED_KINDS: Final = ("main", "repeat")
"""Kinds of trial whose answers are analysed; practice and catch trials and attention
checks never are."""
