"""Sentences out of pydantic's findings."""

from __future__ import annotations

from typing import Any, Final

from pydantic import ValidationError

WORDS: Final = {
    "extra_forbidden": "unknown key",
    "missing": "is missing",
    "string_pattern_mismatch": "may hold only letters, digits, '_', '-' and '.', and must start "
    "with a letter or digit",
    "string_type": "must be a text in quotes",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "float_type": "must be a number",
    "union_tag_not_found": "'rule' is missing",
    "model_attributes_type": "must be a table of keys and values",
}
"""What the kinds of finding mean in a study file; pydantic's own words serve for the rest."""


def explain(error: ValidationError) -> str:
    """Return every finding of `error` as ``key: what is wrong``, joined into one sentence."""
    found = error.errors(include_url=False)
    findings = []
    for finding in found:
        if finding["type"] == "too_short" and any(_lies_within(f, finding) for f in found):
            # Too few entries are left because others were wrong, which is said already.
            continue
        key = ".".join(str(part) for part in finding["loc"] if part != "[key]")
        message = WORDS.get(finding["type"], finding["msg"].removeprefix("Value error, "))
        if finding["type"] == "union_tag_invalid":
            tag, known = finding["ctx"]["tag"], finding["ctx"]["expected_tags"]
            message = f"unknown rule {tag!r} (use one of {known})"
        findings.append(f"{key}: {message}" if key else message)
    return "; ".join(findings)


def _lies_within(finding: Any, outer: Any) -> bool:
    """Tell whether `finding` is about a part of what `outer` is about."""
    depth = len(outer["loc"])
    return len(finding["loc"]) > depth and finding["loc"][:depth] == outer["loc"]
