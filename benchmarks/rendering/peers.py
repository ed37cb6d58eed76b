"""A plain loop that draws pairs, in its own process with as many threads as it chooses.

It is given the posed mesh: skinning is not counted for it, but for us.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.rendering.measured import Measured
from benchmarks.rendering.sample_motion import gesturing_clip
from motion.body.model import BodyModel
from motion.body.surface import surface_colours
from renderer.framing import Camera, look_at
from renderer.jobs.making import ONE_THREAD
from renderer.look import Look


def write_posed_mesh(path: Path, body: BodyModel, camera: Camera, look: Look, frames: int) -> None:
    """Write the input of a peer: the mesh in each frame, its colours, the camera."""
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
    """Return the plain loop, with pyrender as released and with its cache repaired."""
    plain = [sys.executable, "-m", "benchmarks.rendering.stock_loop", str(posed_mesh)]
    commands = {"plain loop": plain, "patched loop": [*plain, "--patched"]}
    return {name: partial(_run, command) for name, command in commands.items()}


def _run(command: list[str]) -> Measured:
    environment = {name: text for name, text in os.environ.items() if name not in ONE_THREAD}
    done = subprocess.run(  # noqa: S603 - our own program
        command, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise RuntimeError(f"{command[2]} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    result = json.loads(done.stdout.splitlines()[-1])
    return Measured(
        rate=result["frames"] / result["seconds"],
        milliseconds=1000 * result["busy"] / result["frames"],
        peak_mb=result["peak_mb"],
    )
