"""`motionjury recruit`."""

from __future__ import annotations

from pathlib import Path

import click

from motion.errors import InputError
from studyapp.cli.arguments import named_study_folder
from studyapp.cli.recruiting_sites import (
    approve_on_mturk,
    approve_on_prolific,
    change_places_on_prolific,
    create_on_mturk,
    create_on_prolific,
    move_on_prolific,
    publish_on_prolific,
    request_returns,
    show_mturk,
    show_prolific,
    stop_on_mturk,
)
from studyapp.recruitment.invitations import counts, invite, listed_people, numbered
from studyapp.recruitment.record import draw_codes
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import Channel

address = click.option(
    "--address",
    required=True,
    envvar="MOTIONJURY_ADDRESS",
    help="Where the study is served, such as https://study.example.org/.",
)
yes = click.option("--yes", is_flag=True, help="Do it; otherwise only say what would be done.")
live = click.option(
    "--live", is_flag=True, help="Mechanical Turk itself, with real money, not its sandbox."
)

MOST_INVITATIONS = 10_000


@click.group("recruit")
@named_study_folder
@click.pass_context
def command(context: click.Context, folder: StudyFolder) -> None:
    """Bring participants to the study FOLDER, and pay those of a recruiting site.

    Where they come from is recruitment.channel in study.toml. Prolific's token is read from
    PROLIFIC_TOKEN, Mechanical Turk's keys from where boto3 looks for them.
    """
    context.obj = folder


@command.command("codes")
@click.option("--again", is_flag=True, help="Replace the codes that are there.")
@click.pass_obj
def codes(folder: StudyFolder, again: bool) -> None:
    """Draw the study's three codes for Prolific, and write them into study.toml."""
    drawn = draw_codes(folder, again=again)
    if drawn:
        click.echo(f"Wrote codes into {folder.definition}: {', '.join(drawn)}")
    else:
        click.echo("The study has all its codes already; --again replaces them.")


@command.command("create")
@address
@live
@yes
@click.pass_obj
def create(folder: StudyFolder, address: str, live: bool, yes: bool) -> None:
    """Make a draft on Prolific, or a HIT in Mechanical Turk's sandbox.

    A draft costs nothing and nobody sees it before 'publish'. A HIT is offered at once.
    """
    if _channel(folder, "prolific", "mturk") == "prolific":
        create_on_prolific(folder, address, yes=yes)
    else:
        create_on_mturk(folder, address, live=live, yes=yes)


@command.command("publish")
@yes
@click.pass_obj
def publish(folder: StudyFolder, yes: bool) -> None:
    """Offer the study to Prolific's participants; the money is set aside from then on."""
    _channel(folder, "prolific")
    publish_on_prolific(folder, yes=yes)


@command.command("pause")
@click.pass_obj
def pause(folder: StudyFolder) -> None:
    """Let nobody new begin on Prolific; those who have begun may finish."""
    _channel(folder, "prolific")
    move_on_prolific(folder, "PAUSE")


@command.command("resume")
@click.pass_obj
def resume(folder: StudyFolder) -> None:
    """Offer a paused study on Prolific again."""
    _channel(folder, "prolific")
    move_on_prolific(folder, "START")


@command.command("stop")
@live
@click.pass_obj
def stop(folder: StudyFolder, live: bool) -> None:
    """End recruiting; those who have begun may finish."""
    if _channel(folder, "prolific", "mturk") == "prolific":
        move_on_prolific(folder, "STOP")
    else:
        stop_on_mturk(folder, live=live)


@command.command("places")
@click.argument("count", type=click.IntRange(1, 10_000))
@click.pass_obj
def places(folder: StudyFolder, count: int) -> None:
    """Let COUNT participants in all take part on Prolific; there can only be more than before."""
    _channel(folder, "prolific")
    change_places_on_prolific(folder, count)


@command.command("status")
@live
@click.pass_obj
def status(folder: StudyFolder, live: bool) -> None:
    """Show how recruiting goes, there and here."""
    if _channel(folder, "prolific", "mturk", "invitations") == "prolific":
        show_prolific(folder)
    elif folder.study().recruitment.channel == "mturk":
        show_mturk(folder, live=live)
    else:
        _show_invitations(folder)


@command.command("approve")
@live
@click.option(
    "--also",
    multiple=True,
    metavar="SUBMISSION",
    help="Pay this submission on Prolific too, as you decided; can be given several times.",
)
@yes
@click.pass_obj
def approve(folder: StudyFolder, live: bool, also: tuple[str, ...], yes: bool) -> None:
    """Show who is to be paid and why, and with --yes pay them.

    The rule is recruitment.unpaid_failed_checks in study.toml. Nobody is ever rejected from here.
    """
    if _channel(folder, "prolific", "mturk") == "prolific":
        approve_on_prolific(folder, also=also, yes=yes)
    else:
        approve_on_mturk(folder, live=live, yes=yes)


@command.command("return")
@click.argument("submissions", nargs=-1, required=True)
@click.option("--reason", required=True, help="What the participants are told.")
@click.pass_obj
def return_(folder: StudyFolder, submissions: tuple[str, ...], reason: str) -> None:
    """Ask participants to return their SUBMISSIONS on Prolific, which are then not paid."""
    _channel(folder, "prolific")
    request_returns(folder, submissions, reason)


@command.command("invite")
@address
@click.option("--count", type=click.IntRange(1, MOST_INVITATIONS), help="How many links to make.")
@click.option(
    "--list",
    "people",
    type=click.Path(path_type=Path, exists=True, dir_okay=False),
    help="A CSV file with a heading, and one person a line in its first column.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="The table of links; invitations.csv in the study folder by default.",
)
@click.pass_obj
def invite_(
    folder: StudyFolder, address: str, count: int | None, people: Path | None, out: Path | None
) -> None:
    """Make links, each for one person, and add them to a table.

    Keep the table to yourself: only it says whose link is whose, and links cannot be shown again.
    """
    _channel(folder, "invitations")
    if (count is None) == (people is None):
        raise click.UsageError("Give either --count or --list.")
    table = out or folder.root / "invitations.csv"
    names = numbered(count, table) if count is not None else listed_people(people or Path())
    made = invite(folder, names, address, table)
    click.echo(f"Added {made} links to {table}")


def _channel(folder: StudyFolder, *needed: Channel) -> Channel:
    """Return the study's channel, if it is one of those that the command is for."""
    channel = folder.study().recruitment.channel
    if channel not in needed:
        raise InputError(
            f"the study's participants come by {channel!r}, and this command is for "
            + " and ".join(repr(each) for each in needed),
            where=folder.definition,
            remedy="Set recruitment.channel",
        )
    return channel


def _show_invitations(folder: StudyFolder) -> None:
    found = counts(folder)
    click.echo(
        f"{found.made} invitations: {found.begun} have begun, {found.completed} have finished."
    )
