import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import Mock

import pytest

from motion.errors import InputError
from studyapp.cli import main as front
from studyapp.cli.main import main
from tests.analysis.results.made_tables import pairwise_table
from tests.support.command_line import refused, run
from tests.support.studies.takes import write_motion


def test_the_nearest_command_is_suggested_for_a_misspelt_one() -> None:
    near = "(Did you mean one of: 'export', 'recruit', 'report'?)"
    assert f"No such command 'reprot'. {near}" in refused("reprot")
    assert "Did you mean 'diffsheg'?" in refused("train", "diffshg")


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        *((name, "not valid TOML") for name in ("export", "report", "metrics", "generate")),
        ("publish-media s3://bucket", "not valid TOML"),
        ("recruit status", "not valid TOML"),
        ("researchers reset Eve", "no researcher 'Eve'"),
        ("exclude 1 --reason asleep", "no database of answers yet"),
        ("forget 1", "no database of answers"),
        ("backup out.zip", "no database of answers"),
    ],
)
def test_a_command_without_a_folder_uses_the_working_directory(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, command: str, answer: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text("trials = [")
    assert answer in refused(*command.split())


def test_bad_input_is_one_sentence_without_a_traceback(tmp_path: Path) -> None:
    error = refused("check", tmp_path)
    assert "study.toml is missing" in error and "motionjury init" in error
    (tmp_path / "file").touch()
    study = tmp_path / "file" / "study"

    for each in (error, refused("init", study)):
        assert "Traceback" not in each
        assert each.startswith(f"Error: {tmp_path}")


@pytest.mark.parametrize(
    ("number", "sentences"),
    [
        (errno.ENOSPC, "No space left on device. Free up space, and run the same command again."),
        (errno.EIO, "Input/output error. Check the path, and that it is readable and writable."),
    ],
)
def test_a_full_or_failing_disk_is_reported_without_a_traceback_and_with_the_file(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, number: int, sentences: str
) -> None:
    error = OSError(number, os.strerror(number))
    monkeypatch.setattr(Path, "write_text", Mock(side_effect=error))
    path = tmp_path / "study" / "study.toml"
    assert refused("init", path.parent) == f"Error: {path}: {sentences}\n"


def test_a_closed_pipe_ends_a_command_without_a_word() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "studyapp.cli.main", "init", "--help"]
    with os.fdopen(writing, "w") as closed:
        done = subprocess.run(command, stdout=closed, stderr=subprocess.PIPE, check=False)
    assert done.stderr == b""


def test_debug_shows_a_traceback(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "argv", ["motionjury", "--debug", "check", str(tmp_path)])
    with pytest.raises(InputError, match=r"study\.toml is missing"):
        main()


@pytest.mark.parametrize("sign", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_command_says_how_to_resume(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], sign: signal.Signals
) -> None:
    def interrupted(**_: object) -> None:
        signal.raise_signal(sign)

    monkeypatch.setattr(front, "group", interrupted)
    with pytest.raises(SystemExit) as exit_:
        main()
    assert exit_.value.code == 130
    assert "Run the same command again" in capsys.readouterr().err


def test_an_interruption_where_python_only_prints_it_is_repeated(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Finalized:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGINT)

    def interrupted(**_: object) -> None:
        Finalized()
        time.sleep(20)

    monkeypatch.setattr(front, "group", interrupted)
    with pytest.raises(SystemExit) as exit_:
        main()
    assert exit_.value.code == 130


WITHOUT_MOTION = """
import sys
from importlib.abc import MetaPathFinder


class Absent(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {"torch", "transformers", "accelerate", "OpenGL", "pyrender"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


sys.meta_path.insert(0, Absent())
from studyapp.cli.main import main

main()
"""


def run_without_motion(*arguments: object, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", WITHOUT_MOTION, *map(str, arguments)],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
def test_a_report_needs_neither_networks_nor_graphics_nor_a_certain_hash_seed(
    tmp_path: Path,
) -> None:
    table = tmp_path / "answers.csv"
    pairwise_table(participants=4, segments=4).to_csv(table, index=False)
    options = ("report", "--responses", table, "--protocol", "pairwise", "--margin", "0.1", "--out")
    run(*options, tmp_path / "here")
    another = "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"

    done = run_without_motion(*options, tmp_path / "there", PYTHONHASHSEED=another)

    assert done.returncode == 0, done.stderr
    assert "report.html" in bytes_in(tmp_path / "here")
    assert bytes_in(tmp_path / "here") == bytes_in(tmp_path / "there")


def bytes_in(folder: Path) -> dict[str, bytes]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_a_command_that_draws_motion_says_how_to_install_graphics(tmp_path: Path) -> None:
    done = run_without_motion("preview", write_motion(tmp_path / "a.npz", 1.0))

    assert done.returncode == 1
    assert "pip install 'motionjury[motion]'" in done.stderr
    assert "Traceback" not in done.stderr
