"""`motionjury recruit`."""

from collections import Counter
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path
from typing import Final

import click

from motion.errors import InputError, counted, listed
from studyapp.cli.arguments import EXISTING_FILE, StudyGroup, public_address, study_folder
from studyapp.cli.output import echo_table
from studyapp.preflight.recruiting_checks import pay_findings
from studyapp.recruitment import mturk, prolific
from studyapp.recruitment.invitations import counts, invite, listed_people
from studyapp.recruitment.payment import PaymentDecision
from studyapp.recruitment.prolific import CENTS
from studyapp.recruitment.prolific_client import Action, ProlificClient, prolific_token
from studyapp.recruitment.record import draw_codes
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.recruitment import Channel, format_amount, hourly_rate

address = public_address(
    help="The study's public address, such as https://study.example.org/.", required=True
)
yes = click.option(
    "--yes", is_flag=True, help="Do it, instead of only printing what would be done."
)
live = click.option(
    "--live",
    is_flag=True,
    help="Use Mechanical Turk itself, with real money, instead of its sandbox.",
)

_ACTIONS: Final = {"pay": "pay", "look": "your decision", "wait": "wait", "settled": "–"}


@click.group("recruit", cls=StudyGroup)
@study_folder
@click.pass_context
def command(context: click.Context, folder: StudyFolder) -> None:
    """Recruit participants for the study FOLDER, and pay them on a recruiting site.

    recruitment.channel in study.toml names the site. Prolific's token is read from PROLIFIC_TOKEN;
    boto3 finds the keys for Mechanical Turk.
    """
    context.obj = folder


@command.subcommand("codes")
def codes(folder: StudyFolder) -> None:
    """Draw three Prolific codes, for study.toml."""
    drawn = draw_codes(folder)
    click.echo(f"Write these into {folder.definition}, under [recruitment.prolific]:")
    for key, code in drawn.items():
        click.echo(f'{key} = "{code}"')


@command.subcommand("create")
@address
@live
@yes
def create(folder: StudyFolder, address: str, live: bool, yes: bool) -> None:
    """Create a draft on Prolific, or a HIT in Mechanical Turk's sandbox.

    A draft costs nothing and is not public before 'publish'. A HIT is public at once.
    """
    if _channel(folder, "prolific", "mturk") == "prolific":
        _create_on_prolific(folder, f"{address}/", yes=yes)
    else:
        _create_on_mturk(folder, f"{address}/", live=live, yes=yes)


@command.subcommand("publish")
@yes
def publish(folder: StudyFolder, yes: bool) -> None:
    """Publish the study on Prolific, which reserves the money that 'create' shows."""
    _channel(folder, "prolific")
    _echo_pay_warnings(folder)
    if yes:
        _move(folder, "PUBLISH")
    else:
        click.echo("Nothing was published; --yes publishes the study.")


@command.subcommand("pause")
def pause(folder: StudyFolder) -> None:
    """Pause the study on Prolific; participants who have begun can finish."""
    _move(folder, "PAUSE")


@command.subcommand("resume")
def resume(folder: StudyFolder) -> None:
    """Resume a paused study on Prolific."""
    _move(folder, "START")


@command.subcommand("stop")
@live
def stop(folder: StudyFolder, live: bool) -> None:
    """Stop recruiting; participants who have begun can finish."""
    if _channel(folder, "prolific", "mturk") == "prolific":
        _move(folder, "STOP")
        return
    hits = mturk.hits_of(folder, live=live)
    client = mturk.connect(live=live)
    for hit in hits:
        client.stop(hit)
        click.echo(f"HIT {hit} is no longer offered.")


@command.subcommand("status")
@live
def status(folder: StudyFolder, live: bool) -> None:
    """Show the state of recruiting, on the site and in the study."""
    channel = _channel(folder, "prolific", "mturk", "invitations")
    if channel == "prolific":
        _show_prolific(folder)
    elif channel == "mturk":
        _show_mturk(folder, live=live)
    else:
        made = counts(folder)
        click.echo(f"{made.made} invitations: {made.begun} begun, {made.completed} completed.")


@command.subcommand("approve")
@live
@yes
def approve(folder: StudyFolder, live: bool, yes: bool) -> None:
    """Show whom to pay and why, and with --yes pay them.

    The rule is recruitment.unpaid_failed_checks in study.toml. This command never rejects anybody.
    """
    if _channel(folder, "prolific", "mturk") == "prolific":
        _approve_on_prolific(folder, yes=yes)
    else:
        _approve_on_mturk(folder, live=live, yes=yes)
    if not yes:
        click.echo("Nothing was paid; --yes pays.")


@command.subcommand("return")
@click.argument("submissions", nargs=-1, required=True)
@click.option("--reason", required=True, help="The reason that participants are given.")
def return_(folder: StudyFolder, submissions: tuple[str, ...], reason: str) -> None:
    """Ask participants to return their SUBMISSIONS on Prolific without pay."""
    _channel(folder, "prolific")
    with _client() as client:
        by_id = {each.id: each for each in client.submissions(prolific.study_id(folder))}
        for name in dict.fromkeys(submissions):
            submission = by_id.get(name)
            if submission is None:
                click.echo(f"{name}: not a submission of this study")
            elif submission.return_requested:
                click.echo(f"{name}: already requested")
            else:
                client.request_return(name, reason)
                click.echo(f"{name}: return requested")


@command.subcommand("invite")
@address
@click.option(
    "--list",
    "people",
    type=EXISTING_FILE,
    required=True,
    help="A CSV file with a header, and one person per row in its first column.",
)
def invite_(folder: StudyFolder, address: str, people: Path) -> None:
    """Make personal links and add them to invitations.csv in the study folder.

    Keep the table confidential: it alone says whose link is whose. Links cannot be shown again.
    """
    _channel(folder, "invitations")
    table = folder.root / "invitations.csv"
    count = invite(folder, listed_people(people), address, table)
    click.echo(f"Added {counted(count, 'link')} to {table}")


def _channel(folder: StudyFolder, *supported: Channel) -> Channel:
    """Return the study's channel if the command supports it."""
    channel = folder.study().recruitment.channel
    if channel not in supported:
        raise InputError(
            f"the study recruits by {channel!r}, but this command is for "
            + listed([repr(name) for name in supported]),
            where=folder.definition,
            remedy="Set recruitment.channel",
        )
    return channel


def _move(folder: StudyFolder, action: Action) -> None:
    _channel(folder, "prolific")
    identity = prolific.study_id(folder)
    with _client() as client:
        study = client.move(identity, action)
    click.echo(f"The study is {study.status.lower()} on Prolific.")


def _create_on_prolific(folder: StudyFolder, address: str, *, yes: bool) -> None:
    draft = prolific.draft_of(folder, address)
    places, minutes = draft["total_available_places"], draft["estimated_completion_time"]
    pay, currency = Decimal(draft["reward"]) / CENTS, folder.study().recruitment.currency
    click.echo(
        f"{draft['name']}: {counted(places, 'place')}, {counted(minutes, 'minute')}, "
        f"{format_amount(pay, currency)} each"
    )
    click.echo(
        f"That is {format_amount(hourly_rate(pay, minutes), currency)} per hour, and "
        f"{format_amount(places * pay, currency)} in total, without Prolific's fee."
    )
    _echo_pay_warnings(folder)
    click.echo(f"Participants are sent to {draft['external_study_url']}")
    if not yes:
        click.echo("Nothing was sent; --yes creates the draft.")
        return
    with _client() as client:
        study, is_new = prolific.create(folder, client, address)
    words = f"Created the draft {study.id}" if is_new else f"The study {study.id} already exists"
    click.echo(f"{words} on Prolific ({study.status}). Publish it with 'publish'.")


def _echo_pay_warnings(folder: StudyFolder) -> None:
    for finding in pay_findings(folder.study(), None):
        if finding.severity == "warning":
            click.echo(f"Warning: {finding.what}. {finding.remedy}.")


def _show_prolific(folder: StudyFolder) -> None:
    with _client() as client:
        status = prolific.status(folder, client)
    study = status.study
    click.echo(
        f"Prolific: {study.status.lower()}, {study.places_taken or 0} of "
        f"{study.total_available_places or 0} places taken"
    )
    echo_table(
        ("on Prolific", "in the study", "count"),
        [
            (site_state.lower(), study_state.replace("_", " "), str(count))
            for (site_state, study_state), count in sorted(status.status_counts.items())
        ],
    )


def _approve_on_prolific(folder: StudyFolder, *, yes: bool) -> None:
    with _client() as client:
        status = prolific.status(folder, client)
        _echo_verdicts(
            "submission", [(each.submission.id, each.decision) for each in status.submissions]
        )
        if yes:
            click.echo(f"Approved {counted(prolific.approve(client, status), 'submission')}.")


def _client() -> ProlificClient:
    return ProlificClient(prolific_token())


def _create_on_mturk(folder: StudyFolder, address: str, *, live: bool, yes: bool) -> None:
    site = "for real money" if live else "in the sandbox, where nobody is paid"
    request = mturk.request_of(folder, address, live=live)
    workers, reward = request["MaxAssignments"], request["Reward"]
    total = workers * folder.study().recruitment.mturk.dollars
    click.echo(
        f"{request['Title']}: {counted(workers, 'worker')} at ${reward} each, ${total} in total "
        f"without fees; {site}"
    )
    _echo_pay_warnings(folder)
    if not yes:
        click.echo("Nothing was offered; --yes offers the HIT.")
        return
    hit = mturk.create(folder, mturk.connect(live=live), address, live=live)
    click.echo(f"Created HIT {hit.id}; workers can see it now.")


def _show_mturk(folder: StudyFolder, *, live: bool) -> None:
    client = mturk.connect(live=live)
    echo_table(
        ("HIT", "state", "wanted", "free", "under way", "reviewed"),
        [
            (
                hit.id,
                hit.status,
                *(str(n) for n in (hit.wanted, hit.available, hit.pending, hit.completed)),
            )
            for hit in map(client.hit, mturk.hits_of(folder, live=live))
        ],
    )


def _approve_on_mturk(folder: StudyFolder, *, live: bool, yes: bool) -> None:
    client = mturk.connect(live=live)
    judged = mturk.judged_assignments(folder, client, live=live)
    _echo_verdicts("assignment", [(assignment.id, decision) for assignment, decision in judged])
    if yes:
        click.echo(f"Approved {counted(mturk.approve(client, judged), 'assignment')}.")


def _echo_verdicts(heading: str, verdicts: Sequence[tuple[str, PaymentDecision]]) -> None:
    """Print what to do about each submission, by name, and the totals."""
    echo_table(
        (heading, "action", "reason"),
        [(name, _ACTIONS[decision.verdict], decision.reason) for name, decision in verdicts],
    )
    totals = Counter(decision.verdict for _, decision in verdicts)
    click.echo(
        f"{totals['pay']} to pay, {totals['look']} for you to decide, {totals['wait']} under way, "
        f"{totals['settled']} settled."
    )
