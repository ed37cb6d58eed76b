"""Changes to the studies of tests."""

from __future__ import annotations

from pathlib import Path


def redefine(study: Path, *changes: tuple[str, str], added: str = "") -> None:
    """Change the study file in the folder `study`.

    Parameters
    ----------
    changes : tuple of str and str
        What stands there, and what stands there instead.
    added : str
        What stands at its end.
    """
    definition = study / "study.toml"
    text = definition.read_text("utf-8")
    for old, new in changes:
        assert old in text, f"the study file does not say {old!r}"
        text = text.replace(old, new)
    definition.write_text(text + added, "utf-8")
