"""`motionjury researchers`."""

from __future__ import annotations

from contextlib import closing
from typing import cast

import click

from studyapp.cli.arguments import public_address, study_folder
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.researchers import credentials as second_factor
from studyapp.researchers import links
from studyapp.researchers.account import ROLES, Account, Role, list_accounts
from studyapp.study.folder import StudyFolder


def listed_researchers(folder: StudyFolder) -> list[Account]:
    """Return all researchers; nobody where the study has no database yet."""
    database = Database.open_for_reading(database_url_of(folder.root))
    if database is None:
        return []
    with closing(database):
        return list_accounts(database)


def _opened(folder: StudyFolder) -> closing[Database]:
    return closing(Database.open(database_url_of(folder.root)))


def _say_link(address: str, token: str) -> None:
    click.echo(f"{address}/research/join/{token}")


address = public_address(
    default="http://127.0.0.1:8000/", help="Where the study is served; the link begins with it."
)


@click.group("researchers")
@study_folder
@click.pass_context
def command(context: click.Context, folder: StudyFolder) -> None:
    """Say who may see the pages of the study FOLDER, and let people in.

    Owners do the same on those pages; this is for somebody who is locked out.
    """
    context.obj = folder


@command.command("list")
@click.pass_obj
def list_(folder: StudyFolder) -> None:
    """List all researchers with their roles."""
    found = listed_researchers(folder)
    for account in found:
        out = ", no access" if account.disabled_at else ""
        out += ", second factor" if account.has_second_factor else ""
        click.echo(f"{account.name} ({account.role}{out}), since {account.joined_at:%Y-%m-%d}")
    if not found:
        click.echo("Nobody yet; 'motionjury serve' prints a link for the first owner.")


@command.command("invite")
@click.option("--role", type=click.Choice(ROLES), required=True, help="What they may do.")
@address
@click.pass_obj
def invite(folder: StudyFolder, role: str, address: str) -> None:
    """Print a link with which somebody joins: once, within three days."""
    with _opened(folder) as database:
        _say_link(address, links.invite(database, Clock(), role=cast(Role, role), by=""))


@command.command("reset")
@click.argument("name")
@address
@click.pass_obj
def reset(folder: StudyFolder, name: str, address: str) -> None:
    """Print a link with which the researcher NAME chooses a new password: once, within a day."""
    with _opened(folder) as database:
        _say_link(address, links.offer_new_password(database, Clock(), name=name, by=""))


@command.command("reset-second-factor")
@click.argument("name")
@click.pass_obj
def reset_second_factor(folder: StudyFolder, name: str) -> None:
    """Let the researcher NAME, whose device is lost, log in without a code again."""
    with _opened(folder) as database:
        second_factor.reset_second_factor(database, Clock(), name=name)
    click.echo(f"{name} logs in with the password alone, until they turn a second factor on again.")
