"""The pages that show a study's texts, as participants see them, before the study can be served."""

import re
from collections.abc import Iterator, Sequence
from typing import Final

from studyapp.session.participation import Situation
from studyapp.session.trials import PREVIEW_TOKEN
from studyapp.study.design.trial import PlannedTrial, has_sound
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study
from studyapp.web.app import StudyWeb
from studyapp.web.language import language_of, speak
from studyapp.web.participants import entrance, participant

_SCRIPTS: Final = re.compile(r"<script\b.*?</script>", re.DOTALL)


def text_pages(study: Study, trials: Sequence[PlannedTrial]) -> dict[str, str]:
    """Return each page's HTML, without scripts, by its title, in the participants' order.

    Parameters
    ----------
    trials : sequence of PlannedTrial
        Trials of one participant, which the instructions count; empty leaves those out.
    """
    app = StudyWeb()
    speak(app, language_of(study.page.language))
    app.register_blueprint(entrance.pages)
    app.register_blueprint(participant.pages)
    with app.test_request_context():
        return {title: _SCRIPTS.sub("", html) for title, html in _pages(study, trials)}


def _pages(study: Study, trials: Sequence[PlannedTrial]) -> Iterator[tuple[str, str]]:
    if study.form.eligibility:
        yield "Eligibility", _entrance(study, trials, "eligibility")
    yield "Consent", _entrance(study, trials, "consent")
    if study.form.questions_at("demographics"):
        yield "Questions before the trials", _situation(study, trials, form="demographics")
    if trials:
        yield "Instructions", _situation(study, trials)
    if study.form.questions_at("closing"):
        yield "Questions after the trials", _situation(study, trials, form="closing")


def _entrance(study: Study, trials: Sequence[PlannedTrial], stage: Stage) -> str:
    videos = (video for trial in trials for video in trial.players.values())
    newcomer = entrance.Entrant(visit="", recruiter={}, answers={})
    return entrance.entrance_page(stage, study, newcomer, has_sound=not trials or has_sound(videos))


def _situation(study: Study, trials: Sequence[PlannedTrial], form: Stage | None = None) -> str:
    situation = Situation(
        state="instructed",
        presentations=len(trials),
        practice=sum(trial.kind == "practice" for trial in trials),
        form=form,
    )
    return participant.situation_page(study, PREVIEW_TOKEN, situation)
