"""What comes before and between the trials: the sound check, and breaks."""

from dataclasses import replace

import pytest

from studyapp.session.enrolment import Arrival
from studyapp.session.form_answers import store_form_answers
from studyapp.session.participation import check_sound, digits_to_speak, leave_break
from studyapp.session.refusal import ConflictError, UnacceptableError
from studyapp.session.trials import minutes_left
from studyapp.study.design.trial import Stimulus
from tests.studyapp.session.conftest import Open
from tests.support.studies.form_questions import ABOUT, ADULT, FORM
from tests.support.studies.taking_part_steps import Participant

SOUND_CHECK = ("[page]\n", "[page]\nsound_check = true\n")


@pytest.fixture
def listener(open_changed: Open) -> Participant:
    return open_changed(SOUND_CHECK).enrol()


def digits(participant: Participant) -> str:
    participant.look()
    return digits_to_speak(participant.database, participant.served, participant.token)


def hear(participant: Participant, typed: str) -> bool:
    return participant.do(check_sound, typed)


def test_wrong_digits_are_counted_and_exclude_nobody(listener: Participant) -> None:
    assert listener.look().sound_tries == 0
    assert listener.begin().look().state == "instructed"
    spoken = digits(listener)
    assert len(spoken) == 3
    with pytest.raises(UnacceptableError, match="No digits"):
        hear(listener, "none")
    for tries in range(1, 6):
        assert not hear(listener, "".join(str((int(digit) + 1) % 10) for digit in spoken))
        assert (listener.look().sound_tries, digits(listener)) == (tries, spoken)

    assert hear(listener, spoken)

    assert hear(listener, "000" if spoken != "000" else "111")
    with pytest.raises(ConflictError, match="not the page you are on"):
        digits(listener)
    assert listener.stored().sound_tries == 5
    assert listener.look().sound_tries is None
    assert listener.begin().look().state == "started"


@pytest.mark.parametrize("between", ["", ", ", "-"])
def test_digits_may_have_separators_and_any_width(listener: Participant, between: str) -> None:
    wide = [chr(ord("０") + int(digit)) for digit in digits(listener)]

    assert hear(listener, between.join(wide))


def test_questions_come_after_the_sound_check(open_changed: Open) -> None:
    listener = open_changed(SOUND_CHECK, added=FORM)
    listener.arrive(Arrival(visit="visit", form=ADULT))
    assert listener.look().form is None
    with pytest.raises(ConflictError, match="not the page you are on"):
        listener.do(store_form_answers, "demographics", ABOUT)
    hear(listener, digits(listener))
    assert listener.look().form == "demographics"


def test_a_study_without_sound_has_no_sound_check(listener: Participant) -> None:
    silent = {
        tuple(Stimulus(condition=s.condition, segment=s.segment, speech=None) for s in content): f
        for content, f in listener.served.videos.items()
    }
    listener.served = replace(listener.served, videos=silent)

    assert listener.begin().look().state == "started"


def test_a_check_and_breaks_that_are_added_later_interrupt_no_trial(
    participant: Participant,
) -> None:
    participant.take_trial()
    participant.trial()
    study = participant.served.study
    page = study.page.model_copy(update={"sound_check": True, "break_every": 1})
    participant.served = replace(participant.served, study=study.model_copy(update={"page": page}))

    assert participant.look().sound_tries is None
    assert participant.trial().position == 2


@pytest.fixture
def resting(open_changed: Open) -> Participant:
    """Return a participant of a study of six trials with a break after every two."""
    return open_changed(("[page]\n", "[page]\nbreak_every = 2\n")).enrol().begin()


def test_breaks_come_between_trials_but_not_right_before_the_end(resting: Participant) -> None:
    breaks = []
    while (situation := resting.look()).state != "completed":
        if (position := situation.break_before) is None:
            resting.take_trial()
            continue
        breaks.append(position)
        assert situation.trial is None
        for stale in (1, 2, 6):
            resting.do(leave_break, stale)
            assert resting.look() == situation
        for _ in range(2):
            resting.do(leave_break, position)
        assert resting.trial().position == position

    assert breaks == [3, 5]


def test_a_break_does_not_count_towards_the_next_trials_time(resting: Participant) -> None:
    for _ in range(2):
        resting.take_trial()
    offered = resting.look().minutes_left
    assert offered is not None

    resting.clock.advance(minutes=30)
    resting.do(leave_break, 3)

    assert resting.trial().minutes_left == offered


@pytest.mark.parametrize(
    ("taken", "ahead", "minutes"),
    [
        ([], [10.0], 1),
        ([(50.0, 25.0)], [300.0] * 2, 20),
        # One long interruption changes nothing.
        ([*[(30.0, 30.0)] * 2, (3600.0, 30.0)], [300.0] * 4, 20),
    ],
)
def test_the_pace_is_the_median_of_the_trials_so_far(
    taken: list[tuple[float, float]], ahead: list[float], minutes: int
) -> None:
    assert minutes_left(taken, ahead) == minutes
