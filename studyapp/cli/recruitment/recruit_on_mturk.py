"""What `motionjury recruit` does with a study on Mechanical Turk, in words."""

from __future__ import annotations

import click

from studyapp.cli.printing import echo_table
from studyapp.cli.recruitment.verdicts import echo_verdicts
from studyapp.recruitment import mturk
from studyapp.recruitment.mturk_client import connect
from studyapp.study.folder import StudyFolder


def create(folder: StudyFolder, address: str, *, live: bool, yes: bool) -> None:
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


def stop(folder: StudyFolder, *, live: bool) -> None:
    """Offer the study's HITs to nobody any more."""
    hits = mturk.hits_of(folder, live=live)
    client = connect(live=live)
    for hit in hits:
        client.stop(hit)
        click.echo(f"HIT {hit} is offered no more.")


def show_status(folder: StudyFolder, *, live: bool) -> None:
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


def approve(folder: StudyFolder, *, live: bool, yes: bool) -> None:
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
