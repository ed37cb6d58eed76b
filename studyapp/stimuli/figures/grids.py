"""Videos for a supplement: conditions side by side with their names, in slow motion if wanted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from motion.errors import InputError
from renderer.encoder import SOUND_RATE
from renderer.figures.grid_video import MIN_SPEED, GridLayout, Panel, write_grid
from renderer.figures.skeleton_lines import Place
from studyapp.stimuli.figures.material import FigureMaterial
from studyapp.study.folder import StudyFolder

WIDEST: Final = 1920
"""Pixels across a video whose panel size was not chosen."""


def write_grid_of(
    folder: StudyFolder,
    *,
    segment: str,
    conditions: Sequence[str],
    speed: float,
    skeleton: Place | None,
    size: int | None,
    closeup: bool,
    output: Path,
    on_frame: Callable[[int, int], None] = lambda done, total: None,
) -> None:
    """Write the video of several conditions side by side.

    Parameters
    ----------
    folder : StudyFolder
        The study; its motion must be complete.
    segment : str
        What is said.
    conditions : sequence of str
        Each ``name`` or ``name=what it is called``; empty for all but the catch motion.
    speed : float
        From `renderer.figures.grid_video.MIN_SPEED` to 1. Slow motion interpolates the original
        motion, so that it is as smooth as at full speed.
    skeleton : {'over', 'beside'} or None
        Where the skeleton is drawn, if it is.
    size : int or None
        Pixels along each side of a panel; None for the study's own, or what makes a video no
        wider than `WIDEST`.
    closeup : bool
        Whether only the faces are shown.
    output : Path
        An MP4 file.
    on_frame : callable
        Called with (frames done, frames in all) after each.
    """
    if not MIN_SPEED <= speed <= 1:
        raise InputError(
            f"speed {speed:g} is not usable", remedy=f"Give {MIN_SPEED:g} to 1, such as 0.25"
        )
    if output.suffix.lower() != ".mp4":
        raise InputError("a grid is written as MP4", where=output, remedy="End its name with .mp4")
    material = FigureMaterial.of(folder)
    excerpt = material.segment(segment)
    names = material.conditions(conditions)
    layout = GridLayout(count=len(names), size=2, widened=skeleton == "beside")
    fitting = WIDEST // (layout.frame[0] // 2) // 2 * 2
    rate = material.plan.look.frame_rate
    panels = [
        Panel(caption=called, clip=material.clip(excerpt, name, frame_rate=rate / speed))
        for name, called in names.items()
    ]
    if closeup:
        material, faces = material.close_to_faces([[panel.clip] for panel in panels])
        panels = [replace(panel, clip=clip) for panel, [clip] in zip(panels, faces, strict=True)]
    with material.stage(size or min(material.plan.look.size, fitting)) as stage:
        write_grid(
            stage,
            material.camera,
            panels,
            material.speech(excerpt, sample_rate=SOUND_RATE),
            speed=speed,
            skeleton=skeleton,
            text=excerpt.transcript,
            video=output,
            on_frame=on_frame,
        )
