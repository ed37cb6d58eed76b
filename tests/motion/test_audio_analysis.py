from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from motion.audio_analysis import librosa_alone

_ENTER = """
import sys
from motion.audio_analysis import librosa_alone
with librosa_alone():
    print("inside", flush=True)
"""


def test_a_second_process_waits_until_the_first_has_done() -> None:
    with librosa_alone():
        other = subprocess.Popen([sys.executable, "-c", _ENTER], stdout=subprocess.PIPE, text=True)
        try:
            other.wait(timeout=3)
            waited = False
        except subprocess.TimeoutExpired:
            waited = True
    said, _ = other.communicate(timeout=60)
    assert waited
    assert said == "inside\n"


def test_nothing_else_in_the_project_imports_librosa() -> None:
    root = Path(__file__).resolve().parents[2]
    packages = ("motion", "generators", "renderer", "analysis", "studyapp")
    importers = [
        path.name
        for package in packages
        for path in (root / package).rglob("*.py")
        if re.search(r"(import|from) librosa\b", path.read_text(encoding="utf-8"))
    ]
    assert importers == ["audio_analysis.py"]
