"""What else draws such pairs, each in a process of its own, with the threads it takes by itself.

All are given the posed mesh, so that skinning is counted for none of them; it is counted for us.
aitviewer is run where the environment variable ``AITVIEWER_PYTHON`` names the interpreter of an
environment that has it, Blender where ``blender`` is on the path.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.rendering.measured import Measured
from benchmarks.rendering.sample_motion import gesturing_clip
from motion.body.model import BodyModel
from motion.body.surface import surface_colours
from renderer.framing import Camera, look_at
from renderer.jobs.local_workers import ONE_THREAD
from renderer.look import Look

_SCRIPTS: Final = Path(__file__).parent


def write_posed_mesh(path: Path, body: BodyModel, camera: Camera, look: Look, frames: int) -> None:
    """Leave what a peer draws: the mesh in each frame, its colours, the camera."""
    clip = gesturing_clip(frames / look.frame_rate, look.frame_rate)
    np.savez(
        path,
        vertices=body.vertices(clip),
        faces=body.faces,
        colours=np.round(surface_colours(body)[:, :3] * 255).astype(np.uint8),
        camera=look_at(np.array(camera.eye), np.array(camera.target)),
        field_of_view=camera.field_of_view,
        size=look.size,
        frame_rate=look.frame_rate,
    )


def peers(posed_mesh: Path) -> dict[str, Callable[[], Measured]]:
    """Return each peer that is on this machine, by name: one call is one run."""
    stock = [sys.executable, "-m", "benchmarks.rendering.stock_loop", str(posed_mesh)]
    commands = {"plain loop": stock, "mended loop": [*stock, "--mended"]}
    display = _display()
    if python := os.environ.get("AITVIEWER_PYTHON"):
        script = str(_SCRIPTS / "aitviewer_loop.py")
        commands["aitviewer"] = [*display, python, script, str(posed_mesh)]
    if blender := shutil.which("blender"):
        script = str(_SCRIPTS / "blender_loop.py")
        commands["blender"] = [
            *display, blender, "--background", "--python", script, "--", str(posed_mesh)
        ]  # fmt: skip
    return {name: partial(_run, command) for name, command in commands.items()}


def _display() -> list[str]:
    """Return how to give a program the display that it asks for even to draw offscreen."""
    wrapper = shutil.which("xvfb-run")
    return [] if os.environ.get("DISPLAY") or wrapper is None else [wrapper, "--auto-servernum"]


def _run(command: list[str]) -> Measured:
    environment = {name: text for name, text in os.environ.items() if name not in ONE_THREAD}
    done = subprocess.run(  # noqa: S603 - programs named above
        command, env=environment, capture_output=True, text=True, check=False
    )
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"frames"')]
    if done.returncode or not lines:
        raise RuntimeError(f"{command[0]} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    result = json.loads(lines[-1])
    return Measured(
        rate=result["frames"] / result["seconds"],
        milliseconds=1000 * result["busy"] / result["frames"],
        peak_mb=result["peak_mb"],
    )
