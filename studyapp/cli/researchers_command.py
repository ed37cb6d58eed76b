"""`motionjury researchers`."""

from contextlib import closing
from typing import cast

import click

from studyapp.cli.arguments import StudyGroup, public_address, study_folder
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.researchers import credentials as second_factor
from studyapp.researchers import links
from studyapp.researchers.account import ROLES, Role, list_accounts
from studyapp.study.folder import StudyFolder


def _open_database(folder: StudyFolder) -> closing[Database]:
    return closing(Database.open(database_url_of(folder.root)))


address = public_address(
    default="http://127.0.0.1:8000/", help="The study's address; the link starts with it."
)


@click.group("researchers", cls=StudyGroup)
@study_folder
@click.pass_context
def command(context: click.Context, folder: StudyFolder) -> None:
    """Manage access to the researchers' pages of the study FOLDER.

    Owners can do the same on those pages; this is for people who are locked out.
    """
    context.obj = folder


@command.subcommand("list")
def list_(folder: StudyFolder) -> None:
    """List all researchers with their roles."""
    database = Database.open_for_reading(database_url_of(folder.root))
    researchers = []
    if database is not None:
        with closing(database):
            researchers = list_accounts(database)
    for account in researchers:
        state = ", no access" if account.disabled_at else ""
        state += ", second factor" if account.has_second_factor else ""
        click.echo(f"{account.name} ({account.role}{state}), since {account.joined_at:%Y-%m-%d}")
    if not researchers:
        click.echo("Nobody yet; 'motionjury serve' prints a link for the first owner.")


@command.subcommand("invite")
@click.option("--role", type=click.Choice(ROLES), required=True, help="Their role.")
@address
def invite(folder: StudyFolder, role: str, address: str) -> None:
    """Print a link to join the study, valid once within three days."""
    with _open_database(folder) as database:
        token = links.invite(database, Clock(), role=cast(Role, role), by="")
    click.echo(f"{address}/research/join/{token}")


@command.subcommand("reset")
@click.argument("name")
@address
def reset(folder: StudyFolder, name: str, address: str) -> None:
    """Print a link for the researcher NAME to choose a new password, valid once within a day."""
    with _open_database(folder) as database:
        token = links.offer_new_password(database, Clock(), name=name, by="")
    click.echo(f"{address}/research/join/{token}")


@command.subcommand("reset-second-factor")
@click.argument("name")
def reset_second_factor(folder: StudyFolder, name: str) -> None:
    """Let the researcher NAME, who lost their device, log in without a code."""
    with _open_database(folder) as database:
        second_factor.reset_second_factor(database, Clock(), name=name)
    click.echo(
        f"{name} can log in with the password alone until they set up a second factor again."
    )
