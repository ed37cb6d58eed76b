from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import click
import pytest

from studyapp.cli import main as front
from studyapp.cli.main import group, main


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    program = "from studyapp.cli.main import main; main()"
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False
    )


def test_help_lists_every_command_with_one_sentence() -> None:
    shown = run("--help")
    assert shown.returncode == 0
    assert shown.stderr == ""
    context = click.Context(group)
    for name in group.list_commands(context):
        assert name in shown.stdout


def test_every_listed_command_is_there_under_its_name() -> None:
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        assert command.name == name
        assert command.help


def test_an_unknown_command_is_refused() -> None:
    assert run("dance").returncode == 2


def test_bad_input_is_one_sentence_without_a_traceback(tmp_path: Path) -> None:
    shown = run("check", str(tmp_path))
    assert shown.returncode == 1
    assert shown.stdout == ""
    assert "study.toml is missing" in shown.stderr
    assert "motionjury init" in shown.stderr
    assert "Traceback" not in shown.stderr


def test_a_folder_in_the_place_of_a_file_is_one_sentence_too(tmp_path: Path) -> None:
    (tmp_path / "study.toml").mkdir()

    shown = run("check", str(tmp_path))

    assert shown.returncode == 1
    assert shown.stderr.startswith(f"Error: {tmp_path / 'study.toml'}: Is a directory.")
    assert "Traceback" not in shown.stderr


def test_debug_shows_where_it_happened(tmp_path: Path) -> None:
    shown = run("--debug", "check", str(tmp_path))
    assert shown.returncode != 0
    assert "Traceback" in shown.stderr


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


@pytest.mark.parametrize("command", ["init", "check", "serve", "export"])
def test_light_commands_load_neither_networks_nor_graphics(command: str) -> None:
    program = (
        "import sys\n"
        "from studyapp.cli.main import group\n"
        f"group.get_command(None, {command!r})\n"
        "heavy = {'torch', 'pyrender', 'OpenGL', 'anny', 'matplotlib', 'librosa'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    shown = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert shown.stdout.strip() == "[]"
