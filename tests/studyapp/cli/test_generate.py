from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest

from motion.formats import read_clip
from tests.generators.diffsheg.small_network import written_network
from tests.studyapp.cli.conftest import CORPUS, RATE
from tests.support.command_line import run
from tests.support.studies.takes import write_speech


def test_recordings_get_motion_without_a_study_and_stand_ins_are_reported(tmp_path: Path) -> None:
    speech = ("--speech", write_speech(tmp_path / "hello.wav", 1))
    checkpoint = written_network(tmp_path / "small.safetensors")
    network = ("generate", "--generator", "diffsheg", "--checkpoint", checkpoint, *speech)
    given = (*network, "--out", tmp_path / "out", "--fps", 25, "--seed")
    output = run(*given, 4)
    assert "Generated 1 clip," in output
    assert "Uses stand-ins: diffsheg: stand-in for HuBERT" in output
    clip = read_clip(tmp_path / "out" / "hello.npz")
    assert (len(clip), clip.frame_rate) == (25, 25)
    assert clip.provenance["seed"] == "4"
    again = run(*given, 4)
    assert "Generated 0 clips, kept 1" in again
    assert "Uses stand-ins" in again
    assert "Generated 1 clip," in run(*given, 5)

    output = run("generate", "--generator", "static", *speech, "--out", tmp_path)
    assert "Uses stand-ins" not in output
    assert len(read_clip(tmp_path / "hello.npz")) == 30


def contents(folder: Path) -> dict[Path, str]:
    return {
        path.relative_to(folder): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.slow
def test_processes_make_the_same_takes_and_existing_ones_are_kept(
    corpus: Path, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(corpus, tmp_path / "corpus"))
    before = contents(folder)
    for speech in sorted(folder.glob("*/*.wav"))[:2]:
        for path in speech.parent.glob(f"{speech.stem}.*"):
            path.unlink()

    done = run("corpus", folder, *CORPUS, *RATE, "--processes", 2)
    assert "Made 2 takes" in done
    assert "kept 14" in done
    assert contents(folder) == before
    assert len(before) == 16 * 6 + 3
