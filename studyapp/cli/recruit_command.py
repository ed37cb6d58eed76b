"""`motionjury recruit`."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import click

from motion.errors import InputError
from studyapp.cli.arguments import named_study_folder
from studyapp.cli.output import echo_table, echo_verdicts
from studyapp.recruitment import mturk, prolific
from studyapp.recruitment.invitations import counts, invite, listed_people, numbered
from studyapp.recruitment.prolific import CENTS
from studyapp.recruitment.prolific_client import Action, ProlificClient, prolific_token
from studyapp.recruitment.record import draw_codes
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import Channel, hourly_rate

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
LEAST_HOURLY = 6.0
"""What Prolific asks researchers to pay for an hour, in pounds."""


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
        _create_on_prolific(folder, address, yes=yes)
    else:
        _create_on_mturk(folder, address, live=live, yes=yes)


@command.command("publish")
@yes
@click.pass_obj
def publish(folder: StudyFolder, yes: bool) -> None:
    """Offer the study to Prolific's participants; the money is set aside from then on."""
    _channel(folder, "prolific")
    identity = prolific.study_id(folder)
    with _client() as client:
        study = client.study(identity)
        places, reward = study.total_available_places or 0, study.reward or 0
        click.echo(
            f"{places} places at {reward / CENTS:.2f} each: {places * reward / CENTS:.2f} without "
            "Prolific's fee."
        )
        if not yes:
            click.echo("Nothing was published; with --yes it is.")
            return
        study = client.move(identity, "PUBLISH")
    click.echo(f"The study is {study.status.lower()} on Prolific.")


@command.command("pause")
@click.pass_obj
def pause(folder: StudyFolder) -> None:
    """Let nobody new begin on Prolific; those who have begun may finish."""
    _move(folder, "PAUSE")


@command.command("resume")
@click.pass_obj
def resume(folder: StudyFolder) -> None:
    """Offer a paused study on Prolific again."""
    _move(folder, "START")


@command.command("stop")
@live
@click.pass_obj
def stop(folder: StudyFolder, live: bool) -> None:
    """End recruiting; those who have begun may finish."""
    if _channel(folder, "prolific", "mturk") == "prolific":
        _move(folder, "STOP")
        return
    hits = mturk.hits_of(folder, live=live)
    client = mturk.connect(live=live)
    for hit in hits:
        client.stop(hit)
        click.echo(f"HIT {hit} is offered no more.")


@command.command("places")
@click.argument("count", type=click.IntRange(1, 10_000))
@click.pass_obj
def places(folder: StudyFolder, count: int) -> None:
    """Let COUNT participants in all take part on Prolific; there can only be more than before."""
    _channel(folder, "prolific")
    identity = prolific.study_id(folder)
    with _client() as client:
        study = client.change_places(identity, count)
    click.echo(f"The study has {study.total_available_places} places on Prolific.")
    click.echo("How many it has here is in study.toml.")


@command.command("status")
@live
@click.pass_obj
def status(folder: StudyFolder, live: bool) -> None:
    """Show how recruiting goes, there and here."""
    if _channel(folder, "prolific", "mturk", "invitations") == "prolific":
        _show_prolific(folder)
    elif folder.study().recruitment.channel == "mturk":
        _show_mturk(folder, live=live)
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
        _approve_on_prolific(folder, also=also, yes=yes)
    else:
        _approve_on_mturk(folder, live=live, yes=yes)


@command.command("return")
@click.argument("submissions", nargs=-1, required=True)
@click.option("--reason", required=True, help="What the participants are told.")
@click.pass_obj
def return_(folder: StudyFolder, submissions: tuple[str, ...], reason: str) -> None:
    """Ask participants to return their SUBMISSIONS on Prolific, which are then not paid."""
    _channel(folder, "prolific")
    with _client() as client:
        known = {each.id: each for each in client.submissions(prolific.study_id(folder))}
        for submission in dict.fromkeys(submissions):
            found = known.get(submission)
            if found is None:
                click.echo(f"{submission}: is none of this study's submissions")
            elif found.return_requested:
                click.echo(f"{submission}: was asked for before")
            else:
                client.request_return(submission, reason)
                click.echo(f"{submission}: asked to return it")


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


def _move(folder: StudyFolder, action: Action) -> None:
    """Start, pause or stop the study on Prolific."""
    _channel(folder, "prolific")
    identity = prolific.study_id(folder)
    with _client() as client:
        study = client.move(identity, action)
    click.echo(f"The study is {study.status.lower()} on Prolific.")


def _create_on_prolific(folder: StudyFolder, address: str, *, yes: bool) -> None:
    """Say what would be sent, and with `yes` make the draft."""
    draft = prolific.draft_of(folder, address)
    places, reward = draft["total_available_places"], draft["reward"]
    minutes, pay = draft["estimated_completion_time"], Decimal(reward) / CENTS
    per_hour = hourly_rate(pay, minutes)
    click.echo(f"{draft['name']}: {places} places, {minutes} minutes, {pay:.2f} each")
    click.echo(
        f"That is {per_hour:.2f} for an hour, and {places * pay:.2f} for all, without Prolific's "
        "fee."
    )
    if per_hour < LEAST_HOURLY:
        click.echo(f"Prolific may refuse less than {LEAST_HOURLY:.2f} pounds for an hour.")
    click.echo(f"Participants come to {draft['external_study_url']}")
    if not yes:
        click.echo("Nothing was sent; with --yes it is.")
        return
    with _client() as client:
        study, made = prolific.create(folder, client, address)
    state = "Made the draft" if made else "There already is the study"
    click.echo(f"{state} {study.id} on Prolific ({study.status}). Publish it with 'publish'.")


def _show_prolific(folder: StudyFolder) -> None:
    """Show places, and submissions there beside participants here."""
    with _client() as client:
        found = prolific.status(folder, client)
    study = found.study
    click.echo(
        f"Prolific: {study.status.lower()}, {study.places_taken or 0} of "
        f"{study.total_available_places or 0} places taken"
    )
    echo_table(
        ("there", "here", "how many"),
        [
            (there.lower(), here.replace("_", " "), str(count))
            for (there, here), count in sorted(found.status_counts.items())
        ],
    )
    if found.missing_there:
        click.echo(
            f"Here, but not there: {len(found.missing_there)} "
            "(they may have come from another study on Prolific)"
        )


def _approve_on_prolific(folder: StudyFolder, *, also: tuple[str, ...], yes: bool) -> None:
    """Show who is to be paid, and with `yes` pay them and those of `also`."""
    with _client() as client:
        found = prolific.status(folder, client)
        echo_verdicts(
            "submission", [(each.submission.id, each.decision) for each in found.submissions]
        )
        if not yes:
            click.echo("Nothing was paid; with --yes it is.")
            return
        click.echo(f"Approved {prolific.approve(client, found, also)} submissions.")


def _client() -> ProlificClient:
    return ProlificClient(prolific_token())


def _create_on_mturk(folder: StudyFolder, address: str, *, live: bool, yes: bool) -> None:
    """Say what would be offered, and with `yes` offer it."""
    where = "for real money" if live else "in the sandbox, where nobody is paid"
    request = mturk.request_of(folder, address, live=live)
    workers, reward = request["MaxAssignments"], request["Reward"]
    total = workers * folder.study().recruitment.mturk.dollars
    click.echo(
        f"{request['Title']}: {workers} workers at ${reward} each, ${total} for all, without fees; "
        f"{where}"
    )
    if not yes:
        click.echo("Nothing was offered; with --yes it is.")
        return
    hit = mturk.create(folder, mturk.connect(live=live), address, live=live)
    click.echo(f"Made HIT {hit.id}; workers see it now.")


def _show_mturk(folder: StudyFolder, *, live: bool) -> None:
    """Show how far every HIT is."""
    hits = mturk.hits_of(folder, live=live)
    client = mturk.connect(live=live)
    found = [client.hit(hit) for hit in hits]
    echo_table(
        ("HIT", "state", "wanted", "free", "under way", "reviewed"),
        [
            (
                hit.id,
                hit.status,
                *(str(n) for n in (hit.wanted, hit.available, hit.pending, hit.completed)),
            )
            for hit in found
        ],
    )
    assignments = mturk.judged_assignments(folder, client, live=live)
    echo_verdicts("assignment", [(each.assignment.id, each.decision) for each in assignments])


def _approve_on_mturk(folder: StudyFolder, *, live: bool, yes: bool) -> None:
    """Show who is to be paid, and with `yes` pay them."""
    mturk.hits_of(folder, live=live)
    client = mturk.connect(live=live)
    found = mturk.judged_assignments(folder, client, live=live)
    echo_verdicts("assignment", [(each.assignment.id, each.decision) for each in found])
    if not yes:
        click.echo("Nothing was paid; with --yes it is.")
        return
    click.echo(f"Approved {mturk.approve(client, found)} assignments.")
