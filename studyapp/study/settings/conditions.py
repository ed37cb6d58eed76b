"""The conditions, catch trials and attention checks of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from generators.registry import generator_names, needs_model, needs_source, settings_type
from generators.settings import Settings
from studyapp.study.settings.sections import Name, Section

if TYPE_CHECKING:
    from studyapp.study.settings.study import Study


class Condition(Section, extra="allow"):
    """One system under comparison; further keys are its generator's (see `settings`).

    Attributes
    ----------
    label : str or None
        Its name on researchers' pages and in reports, such as "Ours (full)"; participants never
        see it.
    generator : str or None
        The generator of its motion; None for imported motion.
    source : str or None
        The condition whose clips the generator starts from, if it needs one.
    videos : bool
        Whether it has finished videos, ``videos/<condition>/<segment>.mp4``, instead of motion.
    generative : bool or None
        Whether it can produce different motion for the same speech, as DiffSHEG's table of metrics
        marks; only the report uses it.
    """

    label: str | None = Field(None, min_length=1, max_length=60)
    generator: str | None = None
    source: Name | None = None
    videos: bool = False
    generative: bool | None = None

    @property
    def settings(self) -> Settings:
        """The keys of its generator, with paths relative to the study folder."""
        kind = Settings if self.generator is None else settings_type(self.generator)
        return kind.model_validate(self.model_extra or {})

    @model_validator(mode="after")
    def _has_valid_settings(self) -> Condition:
        if self.generator is None or self.generator in generator_names():
            _ = self.settings
        return self


class Catch(Section):
    """Catch trials: comparisons with an answer that is obvious to an attentive participant.

    Attributes
    ----------
    trials : int
        Number for each participant.
    condition : str
        Name of the visibly flawed motion.
    generator : str
        Generator of the flawed motion.
    against : str or None
        The condition it is shown beside; by default the ground truth, or the reference in a study
        without one.
    max_failed : int
        More failed catch trials exclude a participant from the analysis, unless `exclusions` set
        another number. AMUSE's text allows one, its appendix none.
    videos : bool
        Whether there are finished videos of the flawed motion.
    """

    trials: int = Field(3, ge=0, le=20)
    condition: Name = "broken"
    generator: str = "broken"
    against: Name | None = None
    max_failed: int = Field(1, ge=0, le=20)
    videos: bool = False


class Attention(Section):
    """Attention checks: trials that look like all others and ask for one particular answer.

    Attributes
    ----------
    trials : int
        Number for each participant.
    max_failed : int
        More failed checks exclude a participant from the analysis, unless `exclusions` set
        another number. Recruiters accept two failed checks as a reason not to pay.
    """

    trials: int = Field(0, ge=0, le=10)
    max_failed: int = Field(1, ge=0, le=10)


def source_problems(conditions: Mapping[str, Condition]) -> list[str]:
    """Return what is wrong with the sources of motion."""
    problems = {name: _source_problem(conditions, name) for name in conditions}
    return [f"conditions.{name}: {problem}" for name, problem in problems.items() if problem]


def _source_problem(conditions: Mapping[str, Condition], name: str) -> str:
    condition = conditions[name]
    generator, source = condition.generator, condition.source
    if condition.videos and (generator is not None or source is not None):
        return "a condition with finished videos cannot have a generator or source"
    if generator is not None and generator not in generator_names():
        return _unknown_generator(generator)
    takes_source = generator is not None and needs_source(generator)
    if source is None:
        return f"the generator {generator!r} needs a source" if takes_source else ""
    if not takes_source:
        return "source has no effect here"
    if source not in conditions or source == name:
        return f"source {source!r} is not another condition"
    if conditions[source].videos:
        return f"source {source!r} has finished videos and no motion"
    return "its sources form a circle" if name in _sources(conditions, source) else ""


def display_name(name: str, condition: Condition) -> str:
    """Return the name of a condition on researchers' pages and in reports."""
    return condition.label or name.replace("_", " ")


def comparison_name(reference: str, other: str) -> str:
    """Return the name of the comparison of `reference` with `other`."""
    return f"{reference}-{other}"


def unknown_condition(key: str, name: str | None, conditions: Mapping[str, Condition]) -> list[str]:
    """Return what is wrong if `key` names none of the conditions."""
    if name is None or name in conditions:
        return []
    return [f"{key} {name!r} is not a condition ({', '.join(conditions)})"]


def catch_problems(conditions: Mapping[str, Condition], catch: Catch) -> list[str]:
    """Return contradictions between the catch trials and the conditions."""
    problems = unknown_condition("catch.against", catch.against, conditions)
    if catch.condition in conditions:
        problems.append(f"catch.condition {catch.condition!r} must not be one of the conditions")
    if catch.generator not in generator_names():
        problems.append(f"catch: {_unknown_generator(catch.generator)}")
    elif needs_model(catch.generator):
        problems.append(f"catch: a network such as {catch.generator!r} cannot make flawed motion")
    return problems


def study_notes(study: Study) -> tuple[str, ...]:
    """Return what a report and a check note about the study's design."""
    if study.has_recording or not study.catch.trials:
        return ()
    names = study.display_names
    return (
        "No condition is a recording of a person, so there is no ground truth: "
        f"catch trials show {names[study.catch_against]} against {names[study.catch.condition]}.",
    )


def with_sources(conditions: Mapping[str, Condition], names: set[str]) -> dict[str, Condition]:
    """Return the conditions `names` and all their sources, in the file's order."""
    needed = {source for name in names for source in _sources(conditions, name)}
    return {name: condition for name, condition in conditions.items() if name in needed}


def generated(conditions: Mapping[str, Condition]) -> dict[str, Condition]:
    """Return every condition with a generator, sources first."""
    ordered = sorted(conditions, key=lambda name: len(_sources(conditions, name)))
    return {name: conditions[name] for name in ordered if conditions[name].generator is not None}


def _sources(conditions: Mapping[str, Condition], name: str) -> tuple[str, ...]:
    """Return `name`, its source, the source of that, and so on, each once."""
    chain: list[str] = []
    source: str | None = name
    while source is not None and source in conditions and source not in chain:
        chain.append(source)
        source = conditions[source].source
    return tuple(chain)


def _unknown_generator(generator: str) -> str:
    return f"unknown generator {generator!r} (use one of {', '.join(generator_names())})"
