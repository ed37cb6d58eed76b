"""Sentences out of pydantic's findings."""

from __future__ import annotations

from pydantic import ValidationError


def explain(error: ValidationError) -> str:
    """Return every finding of `error` as ``key: what is wrong``, joined into one sentence."""
    findings = []
    for finding in error.errors(include_url=False):
        key = ".".join(str(part) for part in finding["loc"] if part != "[key]")
        message = finding["msg"].removeprefix("Value error, ")
        if finding["type"] == "extra_forbidden":
            message = "unknown key"
        elif finding["type"] == "missing":
            message = "is missing"
        findings.append(f"{key}: {message}" if key else message)
    return "; ".join(findings)
