"""Supplementary videos of conditions side by side with their names, also in slow motion."""

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

MAX_WIDTH: Final = 1920
"""Pixels of a video whose panel size is not given."""


def write_condition_grid(
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
        Name of the segment.
    conditions : sequence of str
        Each ``name`` or ``name=label``; empty for all but the catch condition.
    speed : float
        From `renderer.figures.grid_video.MIN_SPEED` to 1. Slow motion interpolates the original
        motion, so it is as smooth as at full speed.
    skeleton : {'over', 'beside'} or None
        Where the skeleton is drawn.
    size : int or None
        Pixels of each panel's side; by default the study's, limited by `MAX_WIDTH`.
    closeup : bool
        Show only the faces.
    output : Path
        An MP4 file.
    on_frame : callable
        Called with (finished frames, all frames) after each.
    """
    if not MIN_SPEED <= speed <= 1:
        raise InputError(
            f"the speed {speed:g} is out of range", remedy=f"Give {MIN_SPEED:g} to 1, such as 0.25"
        )
    if output.suffix.lower() != ".mp4":
        raise InputError("a grid is written as MP4", where=output, remedy="End its name with .mp4")
    material = FigureMaterial.read(folder)
    excerpt = material.segment(segment)
    labels = material.labels(conditions)
    layout = GridLayout(count=len(labels), size=2, widened=skeleton == "beside")
    fitting_size = MAX_WIDTH // (layout.frame[0] // 2) // 2 * 2
    rate = material.plan.look.frame_rate
    panels = [
        Panel(caption=label, clip=material.clip(excerpt, name, frame_rate=rate / speed))
        for name, label in labels.items()
    ]
    if closeup:
        material, faces = material.close_to_faces([[panel.clip] for panel in panels])
        panels = [replace(panel, clip=clip) for panel, [clip] in zip(panels, faces, strict=True)]
    with material.stage(size or min(material.plan.look.size, fitting_size)) as stage:
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
