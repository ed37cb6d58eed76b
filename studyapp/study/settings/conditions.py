"""The conditions of a study, its catch trials and its attention checks."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field, model_validator

from generators.registry import generator_names, needs_model, needs_source, settings_type
from generators.settings import Reader, Settings
from studyapp.study.settings.sections import Name, Section


class Condition(Section, extra="allow"):
    """One system under comparison.

    All further keys are its generator's; see `settings`.

    Attributes
    ----------
    label : str or None
        What researchers and readers of reports see in place of its name, such as "Ours (full)";
        never on a page of participants.
    generator : str or None
        The generator that makes its motion; None when its motion files are imported.
    source : str or None
        The condition whose clips the generator starts from, for generators that need one.
    videos : bool
        Finished videos are brought, ``videos/<condition>/<segment>.mp4``, and no motion.
    generative : bool or None
        Whether it can move differently to one speech, which DiffSHEG's table of metrics marks;
        None where that is not stated. Nothing but the report looks at it.
    """

    label: str | None = Field(None, min_length=1, max_length=60)
    generator: str | None = None
    source: Name | None = None
    videos: bool = False
    generative: bool | None = None

    @property
    def settings(self) -> Settings:
        """What it tells its generator besides speech, with paths from the study's folder."""
        kind = Settings if self.generator is None else settings_type(self.generator)
        reader = Reader(generator=self.generator or "", sibling_keys=tuple(type(self).model_fields))
        return kind.model_validate(self.model_extra or {}, context=reader)

    @model_validator(mode="after")
    def _tells_its_generator_what_it_takes(self) -> Condition:
        """Refuse what the generator does not take: reading the settings checks them."""
        if self.generator is None or self.generator in generator_names():
            _ = self.settings
        return self


class Catch(Section):
    """Catch trials: a comparison whose answer an attentive participant sees at once.

    Attributes
    ----------
    trials : int
        How many each participant gets.
    condition : str
        Name of the visibly flawed motion.
    generator : str
        What makes the flawed motion.
    against : str or None
        The condition it is shown beside; by default the ground truth where the study has one,
        else the reference.
    max_failed : int
        More failed catch trials than this exclude a participant from the analysis, unless a rule
        of `Study.exclusions` has a number of its own. AMUSE's text excludes above one, its
        appendix above none.
    videos : bool
        Finished videos of the flawed motion are brought; nothing makes it.
    """

    trials: int = Field(3, ge=0, le=20)
    condition: Name = "broken"
    generator: str = "broken"
    against: Name | None = None
    max_failed: int = Field(1, ge=0, le=20)
    videos: bool = False


class Attention(Section):
    """Attention checks: pages that look like all others and ask for one certain answer.

    Attributes
    ----------
    trials : int
        How many each participant gets.
    max_failed : int
        More failed checks than this exclude a participant, unless a rule of `Study.exclusions`
        has a number of its own; recruiters accept such an exclusion as a ground for not paying,
        from two failed checks on.
    """

    trials: int = Field(0, ge=0, le=10)
    max_failed: int = Field(1, ge=0, le=10)


def source_problems(conditions: Mapping[str, Condition], name: str) -> list[str]:
    """Return what is wrong with where the motion of condition `name` comes from."""
    condition = conditions[name]
    if condition.videos and (condition.generator is not None or condition.source is not None):
        return [f"conditions.{name}: finished videos have neither generator nor source"]
    if condition.generator is not None and condition.generator not in generator_names():
        return [_unknown_generator(f"conditions.{name}", condition.generator)]
    needs = condition.generator is not None and needs_source(condition.generator)
    if needs and condition.source is None:
        return [f"conditions.{name}: generator {condition.generator!r} needs a source"]
    if condition.source is None:
        return []
    if not needs:
        return [f"conditions.{name}: source is given, but nothing there uses it"]
    if condition.source not in conditions or condition.source == name:
        return [f"conditions.{name}: source {condition.source!r} is no other condition"]
    if conditions[condition.source].videos:
        return [f"conditions.{name}: source {condition.source!r} has finished videos, no motion"]
    if name in _sources(conditions, condition.source):
        return [f"conditions.{name}: its sources run in a circle"]
    return []


def label_problems(conditions: Mapping[str, Condition], catch: Catch) -> list[str]:
    """Return where two conditions would be called the same."""
    called: dict[str, str] = {catch.condition: catch.condition}
    problems = []
    for name, condition in conditions.items():
        shown = display_name(name, condition)
        if called.setdefault(shown, name) != name:
            problems.append(f"conditions.{name}: {called[shown]!r} is called {shown!r} too")
    return problems


def display_name(name: str, condition: Condition) -> str:
    """Return what researchers and readers of reports see in place of a condition's name."""
    return condition.label or name.replace("_", " ")


def comparison_name(reference: str, other: str) -> str:
    """Return the name of the comparison of `reference` with `other`."""
    return f"{reference}-{other}"


def catch_problems(conditions: Mapping[str, Condition], catch: Catch) -> list[str]:
    """Return what does not fit between the catch trials and the conditions."""
    problems = []
    if catch.condition in conditions:
        problems.append(f"catch condition {catch.condition!r} must not be one of the conditions")
    if catch.against is not None and catch.against not in conditions:
        known = ", ".join(conditions)
        problems.append(f"catch.against {catch.against!r} is not a condition ({known})")
    if catch.generator not in generator_names():
        problems.append(_unknown_generator("catch", catch.generator))
    elif needs_model(catch.generator):
        problems.append(
            f"catch: generator {catch.generator!r} is a network, and flawed motion needs another"
        )
    return problems


def with_sources(conditions: Mapping[str, Condition], names: set[str]) -> dict[str, Condition]:
    """Return those of `names` and all their motion is made from, in the file's order."""
    needed = {source for name in names for source in _sources(conditions, name)}
    return {name: made for name, made in conditions.items() if name in needed}


def generated(conditions: Mapping[str, Condition]) -> dict[str, Condition]:
    """Return every condition with a generator, sources first."""
    ordered: dict[str, Condition] = {}
    for name in conditions:
        for needed in reversed(_sources(conditions, name)):
            if conditions[needed].generator is not None:
                ordered.setdefault(needed, conditions[needed])
    return ordered


def _sources(conditions: Mapping[str, Condition], name: str) -> tuple[str, ...]:
    """Return `name`, its source, the source of that, and so on; a circle is gone round once."""
    found: list[str] = []
    following: str | None = name
    while following is not None and following in conditions and following not in found:
        found.append(following)
        following = conditions[following].source
    return tuple(found)


def _unknown_generator(where: str, generator: str) -> str:
    return f"{where}: unknown generator {generator!r} ({', '.join(generator_names())})"
