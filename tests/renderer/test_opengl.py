import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def _run(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("platform", "remark"), [("osmesa", "apt-get install libosmesa6"), ("glx", "looked for glx")]
)
def test_a_missing_offscreen_library_names_what_to_install(platform: str, remark: str) -> None:
    code = "import ctypes.util; ctypes.util.find_library = lambda n: None; import renderer.opengl"
    done = _run(code, PYOPENGL_PLATFORM=platform)
    assert done.returncode != 0
    assert remark in done.stderr


def test_only_drawing_videos_needs_opengl_and_no_window_library() -> None:
    code = "import sys; sys.modules |= {'pyrender': None, 'OpenGL': None}; "
    code += "import renderer.jobs.making, renderer.framing, studyapp.results.report; "
    code += "from renderer.look import Look; from renderer.viewer.page import MotionFigures; "
    code += "MotionFigures(Look()); del sys.modules['pyrender'], sys.modules['OpenGL']; "
    code += "import renderer.frames; sys.exit('pyglet' in sys.modules)"
    done = _run(code)
    assert done.returncode == 0, done.stderr


_DRAW = """
import numpy as np
from renderer.frames import FrameRenderer
from renderer.framing import Camera
corners = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], np.float32)
normals = np.tile(np.array([0, 0, 1], np.float32), (3, 1))
colours = np.tile(np.array([1, 0, 0, 0], np.float32), (3, 1))
camera = Camera(eye=(0, 0, 6), target=(0, 0, 0), field_of_view=20)
with FrameRenderer(np.array([[0, 1, 2]]), colours, camera, 32) as renderer:
    picture = renderer.draw(corners, normals)
    red, green, _ = picture[:, 60, 32]
    assert red > 150 > 50 > green, picture[:, 60, 32]
    assert picture[:, 2, 2].tolist() == [236, 236, 238], picture[:, 2, 2]
"""


@pytest.mark.parametrize("platform", ["osmesa", "egl"])
def test_both_platforms_draw_the_same_picture_upright(platform: str) -> None:
    done = _run(_DRAW, PYOPENGL_PLATFORM=platform)
    if "no offscreen OpenGL library" in done.stderr or "could not be started" in done.stderr:
        pytest.skip(f"{platform} is not on this machine")
    assert done.returncode == 0, done.stderr
