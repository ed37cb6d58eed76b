from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from studyapp.cli.material import render_command
from studyapp.stimuli import rendering
from studyapp.stimuli.render_record import RenderCount


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return what the stage was asked for; it pretends that one clip failed."""
    arguments: dict[str, Any] = {}

    def render(folder: object, **given: Any) -> RenderCount:
        arguments.update(given)
        return RenderCount(made=3, kept=2, failures=("a.mp4: torn",), left_out=2, notes=("soft",))

    monkeypatch.setattr(rendering, "render", render)
    return arguments


def run(study: Path, *arguments: str) -> Result:
    return CliRunner().invoke(render_command.command, [str(study), *arguments])


@pytest.mark.parametrize(("there", "used"), [(3, 3), (384, 256)])
def test_by_default_every_processor_makes_videos_up_to_the_most_allowed(
    tiny_study: Path, asked: dict[str, Any], monkeypatch: pytest.MonkeyPatch, there: int, used: int
) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: set(range(there)), raising=False)
    assert "3 videos" in run(tiny_study).output
    assert asked["processes"] == used


def test_what_was_made_kept_and_failed_is_said_and_a_failure_is_an_error(
    tiny_study: Path, asked: dict[str, Any]
) -> None:
    result = run(tiny_study)
    assert "soft" in result.output
    assert "failed: a.mp4: torn" in result.output
    assert "2 videos made from these clips left out" in result.output
    assert "Rendered 3 videos, kept 2 that still fit." in result.output
    assert "3 videos could not be made" in str(result.exception)
