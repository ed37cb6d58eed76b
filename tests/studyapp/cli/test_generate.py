from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import numpy as np
import pytest

from motion.clip import MotionClip
from motion.formats import read_clip, write_clip
from studyapp.study.study_file import new_study
from tests.generators.diffsheg.small_network import written_network
from tests.studyapp.cli.conftest import CORPUS, RATE
from tests.support.command_line import refused, run
from tests.support.studies.takes import write_speech


@pytest.fixture
def speech(tmp_path: Path) -> Path:
    return write_speech(tmp_path / "hello.wav", 1)


@pytest.fixture
def checkpoint(tmp_path: Path) -> Path:
    return written_network(tmp_path / "small.safetensors")


def test_a_network_generates_motion_without_a_study_and_names_stand_ins(
    speech: Path, checkpoint: Path, tmp_path: Path
) -> None:
    options = ("--generator", "diffsheg", "--checkpoint", checkpoint, "--speech", speech)
    output = run("generate", *options, "--out", tmp_path / "out", "--fps", 25, "--seed", 4)
    assert "Generated 1 clip," in output
    assert "Uses stand-ins: diffsheg: stand-in for HuBERT" in output
    clip = read_clip(tmp_path / "out" / "hello.npz")
    assert (len(clip), clip.frame_rate) == (25, 25)
    assert clip.provenance["seed"] == "4"
    again = run("generate", *options, "--out", tmp_path / "out", "--fps", 25, "--seed", 4)
    assert "Generated 0 clips, kept 1" in again
    assert "Uses stand-ins" in again
    other = run("generate", *options, "--out", tmp_path / "out", "--fps", 25, "--seed", 5)
    assert "Generated 1 clip," in other


def test_a_generator_without_weights_works_too(speech: Path, tmp_path: Path) -> None:
    output = run("generate", "--generator", "static", "--speech", speech, "--out", tmp_path)
    assert "Uses stand-ins" not in output
    assert len(read_clip(tmp_path / "hello.npz")) == 30


def test_other_motion_is_never_overwritten(speech: Path, tmp_path: Path) -> None:
    clip = MotionClip(
        poses=np.zeros((3, 55, 3), np.float32), trans=np.zeros((3, 3), np.float32), frame_rate=30
    )
    write_clip(tmp_path / "hello.npz", clip)
    before = (tmp_path / "hello.npz").read_bytes()
    output = run(
        "generate", "--generator", "static", "--speech", speech, "--out", tmp_path, status=1
    )
    assert "was not generated here" in output
    assert (tmp_path / "hello.npz").read_bytes() == before


def test_two_recordings_of_one_name_are_refused(speech: Path, tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    other = speech.rename(tmp_path / "other" / "hello.wav")
    speech.write_bytes(other.read_bytes())
    both = ("--speech", speech, "--speech", other)
    output = refused("generate", "--generator", "static", *both, "--out", tmp_path)
    assert "two files of speech have the name 'hello'" in output


@pytest.mark.parametrize("options", [(), ("--generator", "static")])
def test_a_study_or_generator_speech_and_out_are_required(options: tuple[str, ...]) -> None:
    output = run("generate", *options, status=1)
    assert "give a study folder, or all of --generator" in output


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (("diffsheg",), "generator 'diffsheg' needs a checkpoint"),
        (("broken",), "changes another condition's motion"),
    ],
)
def test_conflicting_options_are_refused(
    speech: Path, tmp_path: Path, options: tuple[object, ...], error: str
) -> None:
    given = ("--speech", speech, "--out", tmp_path / "out")
    assert error in run("generate", *given, "--generator", *options, status=1)


def test_a_study_takes_no_options_of_single_recordings(speech: Path, tmp_path: Path) -> None:
    new_study(tmp_path / "study" / "study.toml", name="study")
    output = run("generate", tmp_path / "study", "--generator", "static", status=1)
    assert "the generators of a study are set in its study.toml" in output


def test_invalid_sizes_of_a_corpus_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    for options in (("--sentences", 12), ("--held-out-speakers", 8), ("--takes", 99)):
        refused("corpus", tmp_path / "corpus", *options)
        assert not (tmp_path / "corpus").exists()


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
