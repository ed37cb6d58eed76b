from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.cli import main as front
from studyapp.cli.main import main
from tests.analysis.results.made_tables import ranking_table
from tests.support.studies.takes import write_motion

Refused = Callable[..., tuple[int, str]]


@pytest.fixture(name="refused")
def _refused(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Return how a command line is refused: its exit status and what it says."""

    def run(*arguments: str) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["motionjury", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        said, error = capsys.readouterr()
        assert said == ""
        assert isinstance(left.value.code, int)
        return left.value.code, error

    return run


def test_a_misspelt_command_is_told_the_nearest(refused: Refused) -> None:
    status, said = refused("reprot")
    assert status == 2
    assert "No such command 'reprot'. Did you mean 'report'?" in said


@pytest.mark.parametrize("command", ["export", "report", "metrics"])
def test_a_command_without_a_folder_takes_the_one_it_is_run_in(
    refused: Refused, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text("trials = [")
    assert "not valid TOML" in refused(command)[1]


def test_bad_input_is_one_sentence_without_a_traceback(refused: Refused, tmp_path: Path) -> None:
    status, said = refused("check", str(tmp_path))
    assert status == 1
    assert "study.toml is missing" in said
    assert "motionjury init" in said
    assert "Traceback" not in said


def test_a_folder_in_the_place_of_a_file_is_one_sentence_too(
    refused: Refused, tmp_path: Path
) -> None:
    (tmp_path / "study.toml").mkdir()

    status, said = refused("check", str(tmp_path))

    assert status == 1
    assert said.startswith(f"Error: {tmp_path / 'study.toml'}: Is a directory.")
    assert "Traceback" not in said


def test_debug_shows_where_it_happened(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "argv", ["motionjury", "--debug", "check", str(tmp_path)])
    with pytest.raises(InputError, match=r"study\.toml is missing"):
        main()


def test_an_interruption_says_how_to_go_on(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(**_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(front, "group", interrupted)
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 130
    assert "goes on where it stopped" in capsys.readouterr().err


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


def test_a_report_is_written_where_no_networks_and_no_graphics_are_installed(
    tmp_path: Path,
) -> None:
    table = tmp_path / "answers.csv"
    ranking_table(participants=4, segments=3).to_csv(table, index=False)

    options = ["--responses", str(table), "--protocol", "ranking", "--out", str(tmp_path / "out")]
    shown = subprocess.run(
        [sys.executable, "-c", WITHOUT_MOTION, "report", *options],
        capture_output=True,
        text=True,
        check=False,
    )

    assert shown.returncode == 0, shown.stderr
    assert (tmp_path / "out" / "report.html").exists()


def test_what_draws_motion_says_how_to_install_graphics(tmp_path: Path) -> None:
    motion = write_motion(tmp_path / "a.npz", 1.0)

    shown = subprocess.run(
        [sys.executable, "-c", WITHOUT_MOTION, "preview", str(motion)],
        capture_output=True,
        text=True,
        check=False,
    )

    assert shown.returncode == 1
    assert "pip install 'motionjury[motion]'" in shown.stderr
    assert "Traceback" not in shown.stderr
