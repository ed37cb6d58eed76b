"""docs/deploy.md shows what `motionjury deploy` writes, and a server can do what it asks for."""

from importlib.metadata import distributions
from typing import Any

import click
import pytest
from packaging.specifiers import SpecifierSet

from studyapp.cli.serve_command import deploy_command
from studyapp.custody.deployment import deployed_files
from tools.handbook.command_lines import calls
from tools.handbook.deploy_page import DEPLOYMENTS, PAGE, shown_files, up_to_date

TEXT = PAGE.read_text("utf-8")


def test_the_page_shows_every_file_as_it_is_written() -> None:
    assert up_to_date(TEXT) == TEXT, "run 'make pages'"
    assert {block.words[1] for block in shown_files(TEXT)} == {
        file.name for deployment in DEPLOYMENTS.values() for file in deployed_files(deployment)
    }


COMMANDS = [words[1:] for words in calls(TEXT) if words[0] == "deploy"]


@pytest.mark.parametrize("arguments", COMMANDS, ids=" ".join)
def test_commands_on_the_page_write_the_files_on_the_page(arguments: list[str]) -> None:
    parser = deploy_command.make_parser(click.Context(deploy_command))

    parsed: dict[str, Any] = parser.parse_args(list(arguments))[0]

    assert parsed["host"] == "study.example.org"
    shown = DEPLOYMENTS["second" if "proxy" in parsed else ""]
    assert parsed["contact"] == shown.contact
    assert parsed.get("prefix", "") == shown.prefix
    assert parsed.get("database", "sqlite") == shown.database
    assert parsed.get("proxy", "caddy") == shown.proxy


def test_every_package_can_be_installed_with_debian_12s_python() -> None:
    assert [
        package.name
        for package in distributions()
        if "3.11.2" not in SpecifierSet(str(package.metadata.json.get("requires_python", "")))
    ] == []
