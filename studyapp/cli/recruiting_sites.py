"""What `motionjury recruit` does with a study on Prolific and on Mechanical Turk, in words."""

from __future__ import annotations

from collections.abc import Sequence

import click

from studyapp.cli.output import echo_table, echo_verdicts
from studyapp.recruitment import mturk, prolific
from studyapp.recruitment.mturk import connect
from studyapp.recruitment.prolific import CENTS, hourly
from studyapp.recruitment.prolific_client import Action, ProlificClient, prolific_token
from studyapp.study.folder import StudyFolder

LEAST_HOURLY = 6.0
"""What Prolific asks researchers to pay for an hour, in pounds."""


def create_on_prolific(folder: StudyFolder, address: str, *, yes: bool) -> None:
    """Say what would be sent, and with `yes` make the draft."""
    draft = prolific.draft_of(folder, address)
    places, reward = draft["total_available_places"], draft["reward"]
    minutes = draft["estimated_completion_time"]
    click.echo(f"{draft['name']}: {places} places, {minutes} minutes, {reward / CENTS:.2f} each")
    click.echo(
        f"That is {hourly(reward, minutes):.2f} for an hour, and {places * reward / CENTS:.2f} for "
        "all, without Prolific's fee."
    )
    if hourly(reward, minutes) < LEAST_HOURLY:
        click.echo(f"Prolific may refuse less than {LEAST_HOURLY:.2f} pounds for an hour.")
    click.echo(f"Participants come to {draft['external_study_url']}")
    if not yes:
        click.echo("Nothing was sent; with --yes it is.")
        return
    with _client() as client:
        study, made = prolific.create(folder, client, address)
    state = "Made the draft" if made else "There already is the study"
    click.echo(f"{state} {study.id} on Prolific ({study.status}). Publish it with 'publish'.")


def publish_on_prolific(folder: StudyFolder, *, yes: bool) -> None:
    """Say what it costs, and with `yes` publish the draft."""
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


def move_on_prolific(folder: StudyFolder, action: Action) -> None:
    """Start, pause or stop the study."""
    identity = prolific.study_id(folder)
    with _client() as client:
        study = client.move(identity, action)
    click.echo(f"The study is {study.status.lower()} on Prolific.")


def change_places_on_prolific(folder: StudyFolder, count: int) -> None:
    """Set how many participants the study wants there."""
    identity = prolific.study_id(folder)
    with _client() as client:
        study = client.change_places(identity, count)
    click.echo(f"The study has {study.total_available_places} places on Prolific.")
    click.echo("How many it has here is in study.toml.")


def show_prolific(folder: StudyFolder) -> None:
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
            for (there, here), count in sorted(found.there_and_here.items())
        ],
    )
    if found.missing_there:
        click.echo(
            f"Here, but not there: {len(found.missing_there)} "
            "(they may have come from another study on Prolific)"
        )


def approve_on_prolific(folder: StudyFolder, *, also: Sequence[str], yes: bool) -> None:
    """Show who is to be paid, and with `yes` pay them and those of `also`."""
    with _client() as client:
        found = prolific.status(folder, client)
        echo_verdicts(
            "submission", [(each.submission.id, each.judged) for each in found.submissions]
        )
        if not yes:
            click.echo("Nothing was paid; with --yes it is.")
            return
        click.echo(f"Approved {prolific.approve(client, found, also)} submissions.")


def request_returns(folder: StudyFolder, submissions: Sequence[str], reason: str) -> None:
    """Ask for the return of submissions of this study; of no others."""
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


def _client() -> ProlificClient:
    return ProlificClient(prolific_token())


def create_on_mturk(folder: StudyFolder, address: str, *, live: bool, yes: bool) -> None:
    """Say what would be offered, and with `yes` offer it."""
    request = mturk.request_of(folder, address, live=live)
    workers, reward = request["MaxAssignments"], request["Reward"]
    total = workers * folder.study().recruitment.mturk.dollars
    click.echo(
        f"{request['Title']}: {workers} workers at ${reward} each, ${total} for all, without fees; "
        f"{_where(live=live)}"
    )
    if not yes:
        click.echo("Nothing was offered; with --yes it is.")
        return
    hit = mturk.create(folder, connect(live=live), address, live=live)
    click.echo(f"Made HIT {hit.id}; workers see it now.")


def stop_on_mturk(folder: StudyFolder, *, live: bool) -> None:
    """Offer the study's HITs to nobody any more."""
    hits = mturk.hits_of(folder, live=live)
    client = connect(live=live)
    for hit in hits:
        client.stop(hit)
        click.echo(f"HIT {hit} is offered no more.")


def show_mturk(folder: StudyFolder, *, live: bool) -> None:
    """Show how far every HIT is."""
    hits = mturk.hits_of(folder, live=live)
    client = connect(live=live)
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
    echo_verdicts(
        "assignment",
        [(each.assignment.id, each.judged) for each in mturk.judged(folder, client, live=live)],
    )


def approve_on_mturk(folder: StudyFolder, *, live: bool, yes: bool) -> None:
    """Show who is to be paid, and with `yes` pay them."""
    mturk.hits_of(folder, live=live)
    client = connect(live=live)
    found = mturk.judged(folder, client, live=live)
    echo_verdicts("assignment", [(each.assignment.id, each.judged) for each in found])
    if not yes:
        click.echo("Nothing was paid; with --yes it is.")
        return
    click.echo(f"Approved {mturk.approve(client, found)} assignments.")


def _where(*, live: bool) -> str:
    return "for real money" if live else "in the sandbox, where nobody is paid"
