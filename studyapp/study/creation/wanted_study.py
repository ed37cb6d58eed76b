"""What a new study is to be, before there is a study file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.page import Language
from studyapp.study.settings.pay import Pay
from studyapp.study.settings.recruitment import Channel


@dataclass(frozen=True, kw_only=True)
class WantedStudy:
    """What a study file is made from; what is None stays as its template has it.

    Attributes
    ----------
    name : str
        The study's name.
    template : str
        One of `studyapp.study.creation.study_file.TEMPLATES`.
    language : {'en', 'de', 'ja'}
        What participants read in.
    title : str or None
        What participants see as its title.
    reference : str or None
        The condition every other one is compared with; also the source of the template's
        mismatched condition. For pairwise studies. For rankings, the condition that is shown
        apart.
    trials : int or None
        Pairs each participant judges. For pairwise studies.
    participants : int or None
        How many; of pairwise studies, for each comparison.
    conditions : mapping of str to Condition, or None
        Replaces the template's conditions.
    catch_videos : bool
        Whether finished videos of a visibly broken motion will be brought for catch trials.
    channel : {'link', 'prolific', 'mturk', 'invitations'} or None
        Where participants come from.
    pay : Pay or None
        What each of them gets.
    minutes : int or None
        How long it takes.
    organisation, contact, ethics : str or None
        See `studyapp.study.settings.page.Page`.
    """

    name: str
    template: str = "pairwise"
    language: Language = "en"
    title: str | None = None
    reference: str | None = None
    trials: int | None = None
    participants: int | None = None
    conditions: Mapping[str, Condition] | None = None
    catch_videos: bool = False
    channel: Channel | None = None
    pay: Pay | None = None
    minutes: int | None = None
    organisation: str | None = None
    contact: str | None = None
    ethics: str | None = None
