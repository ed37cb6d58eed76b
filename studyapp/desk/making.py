"""Making a study by two pages of questions."""

import shutil
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, Final, cast, get_args

from flask import abort, redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from motion.files import write_text
from studyapp.desk.lab import LabStudy, check_study_name, current_lab
from studyapp.desk.membership import own_study
from studyapp.desk.page import page
from studyapp.researchers.account import Right
from studyapp.study import interview
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.presentation import Framing, Language, Video
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.recruitment import Channel
from studyapp.study.settings.study import Study
from studyapp.study.study_file import render_study_file, template_participants
from studyapp.study.study_options import MAX_VIDEOS_PER_PAGE, StudyOptions, read_conditions
from studyapp.web.research.page import researcher
from studyapp.web.research.pages import Page

AVATARS: Final = get_args(Video.model_fields["avatar"].annotation)
MOST_TRIALS: Final = 500


def choose_template() -> ResponseReturnValue:
    """Ask for the protocol and the language of the study."""
    return page("choose_template", interview=interview)


def describe_study() -> ResponseReturnValue:
    """Ask for everything else, with the template's answers filled in."""
    return _page({})


def make_study() -> ResponseReturnValue:
    """Make the study, owned by the researcher."""
    try:
        name = check_study_name(request.form.get("name", "").strip())
        root = current_lab().folder / name
        definition = StudyFolder(root).definition
        text = render_study_file(_requested_study(name, root), where=definition.name)
        _make_folder(definition, text)
    except InputError as error:
        return _page(request.form.to_dict(), error), 422
    return redirect(url_for("research.study_page", study=name), 303)


def _make_folder(definition: Path, text: str) -> None:
    lab, root = current_lab(), definition.parent
    try:
        root.mkdir()
    except FileExistsError:
        raise InputError(
            f"there is a folder {root.name!r} already", remedy="Give the study another name"
        ) from None
    try:
        # The study file comes last: with it, the folder is a study.
        study = LabStudy(root, lab.database, lab.clock, lab.origin)
        with closing(study.database):
            own_study(study, researcher())
        write_text(definition, text)
    except Exception:
        # Else the name would be taken by a folder that nobody sees.
        shutil.rmtree(root)
        raise


def _requested_study(name: str, root: Path) -> StudyOptions:
    """Return what the form asks for."""
    form = {key: value.strip() for key, value in request.form.items()}
    template, language = _template_and_language(form)
    channel = form.get("channel", "link")
    if channel not in interview.CHANNEL_DESCRIPTIONS:
        abort(400)
    stated = [
        f"{condition.strip()}={source}"
        for condition, source in _condition_rows()
        if condition.strip()
    ]
    conditions = read_conditions(stated, root)
    default = _template_study(template, language)
    return StudyOptions(
        name=name,
        template=template,
        language=cast(Language, language),
        conditions=conditions,
        reference=(form.get("reference") or None) if conditions else None,
        catch_videos="catch_videos" in form and conditions is not None,
        trials=_count(form, "trials", MOST_TRIALS),
        participants=_count(form, "participants", interview.MAX_PARTICIPANTS),
        channel=cast(Channel, channel),
        pay=interview.read_pay(form.get("pay", "")),
        minutes=_count(form, "minutes", interview.MAX_MINUTES),
        title=form.get("title") or None,
        organisation=form.get("organisation", ""),
        contact=form.get("contact", ""),
        ethics=form.get("ethics", ""),
        avatar=form.get("avatar") or None,
        framing=cast("Framing | None", form.get("framing") or None),
        wording={
            question.name: words
            for question in default.questions
            if (words := " ".join(form.get(f"question-{question.name}", "").split()))
            not in ("", question.text)
        },
    )


def _condition_rows() -> list[tuple[str, str]]:
    """Return the names and sources of the conditions in the form."""
    return list(
        zip(request.form.getlist("condition"), request.form.getlist("source"), strict=False)
    )


def _count(form: Mapping[str, str], key: str, most: int) -> int | None:
    count = form.get(key, "")
    return interview.read_count(count, most, unit=key) if count else None


def _template_and_language(form: Mapping[str, str]) -> tuple[str, str]:
    template, language = form.get("template", ""), form.get("language", "en")
    if template not in interview.TEMPLATE_DESCRIPTIONS or language not in interview.LANGUAGES:
        abort(404)
    return template, language


def _template_study(template: str, language: str) -> Study:
    plain = StudyOptions(name="study", template=template, language=cast(Language, language))
    return parse_text(render_study_file(plain, where=template), where=template)


def _page(form: Mapping[str, str], problem: InputError | None = None) -> str:
    template, language = _template_and_language(form or request.args)
    default = _template_study(template, language)
    defaults: dict[str, Any] = {
        "participants": template_participants(template),
        "trials": default.trials if isinstance(default, PairwiseStudy) else None,
        "channel": "link",
        "avatar": default.video.avatar,
        "framing": "",
    }
    return page(
        "describe_study",
        problem=problem,
        answers=defaults | dict(form),
        rows=_condition_rows() or [("", "")] * MAX_VIDEOS_PER_PAGE,
        template=template,
        language=language,
        default=default,
        interview=interview,
        avatars=AVATARS,
        most_trials=MOST_TRIALS,
    )


PAGES: Final = (
    Page("GET", "/make", choose_template, Right.STEER),
    Page("GET", "/make/study", describe_study, Right.STEER),
    Page("POST", "/make/study", make_study, Right.STEER),
)
