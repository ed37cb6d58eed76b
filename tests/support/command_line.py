"""Running `motionjury` in the process of a test."""

import pytest
from click.testing import CliRunner, Result

from studyapp.cli.main import group


def run(*arguments: object, status: int = 0, typed: str = "") -> str:
    """Run a command line, require its exit status, and return its output."""
    done = _done(arguments, typed)
    assert done.exit_code == status, done.output
    return done.output


def refused(*arguments: object) -> str:
    """Run a command line that must be refused, and return its message."""
    done = _done(arguments)
    assert done.exit_code in (1, 2), done.output
    return done.output


def run_in_terminal(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> str:
    """Run a command line that takes its output for a terminal, and return all that it wrote."""
    monkeypatch.setattr("click.testing._NamedTextIOWrapper.isatty", lambda _: True)
    return run(*arguments)


def _done(arguments: tuple[object, ...], typed: str = "") -> Result:
    return CliRunner().invoke(group, [*map(str, arguments)], input=typed, catch_exceptions=False)
