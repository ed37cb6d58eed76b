from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import Invitation
from studyapp.recruitment.invitations import invitation_counts, invited, make_invitations
from studyapp.session.enrolment import Arrival, enrol, resume
from studyapp.session.served_study import ServedStudy
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import Participant, SetClock


@BOTH
def test_an_invitation_gives_one_study_session_and_its_link_is_not_stored(
    opened: Database, served: ServedStudy, clock: SetClock
) -> None:
    tokens = make_invitations(opened, 2, clock)
    with opened.reading() as session:
        stored = set(session.scalars(select(Invitation.token_hash)))
    assert {invited(opened, token) for token in tokens} == stored
    for no_link in ("made-up", *stored):
        assert invited(opened, no_link) is None
    holder = Arrival(visit=invited(opened, tokens[0]))
    assert resume(opened, served, holder, clock) is None

    first = enrol(opened, served, holder, clock)

    assert enrol(opened, served, holder, clock) == first
    assert resume(opened, served, holder, clock) == first
    found = invitation_counts(opened)
    assert (found.made, found.begun, found.completed) == (2, 1, 0)
    Participant(opened, served, clock, first).begin().take_all()
    assert invitation_counts(opened).completed == 1
