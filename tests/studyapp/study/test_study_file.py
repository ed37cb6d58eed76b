import re
from pathlib import Path
from typing import Any

import pytest

from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.presentation import Framing, Language
from studyapp.study.settings.reading import ALIASES, PROTOCOLS, read_study
from studyapp.study.study_file import TEMPLATES, add_condition, new_study, read_texts


def test_every_key_is_in_a_template_or_in_the_documentation() -> None:
    templates, documents = (
        "".join(path.read_text("utf-8") for path in Path(folder).glob(files))
        for folder, files in (("studyapp/study/templates", "**/*.toml"), ("docs", "*.md"))
    )
    templates = re.sub(r"{%.*?%}", "", templates)
    keys_in_templates = re.findall(r"""\b(\w+) = |key\("(\w+)"|'(\w+)'|\[([\w.]+)\]""", templates)
    known = {key for groups in keys_in_templates for group in groups for key in group.split(".")}
    known |= set(re.findall(r"\b(\w+)(?:`| = |\])", documents))
    schemas = [protocol.model_json_schema() for protocol in PROTOCOLS.values()]
    sections = [part for schema in schemas for part in (schema, *schema["$defs"].values())]
    keys = {key for section in sections for key in section.get("properties", ())}
    assert keys - known == set()


@pytest.mark.parametrize("template", TEMPLATES)
def test_each_template_is_a_valid_study_with_comments(tmp_path: Path, template: str) -> None:
    path = tmp_path / "study.toml"
    made = new_study(path, template=template, name="study")
    assert read_study(path) == made
    assert path.read_text().count("#") > 8
    assert all(c.trials == 0 or c.trials > c.max_failed for c in (made.catch, made.attention))


@pytest.mark.parametrize(
    ("template", "published"),
    [
        (
            "pairwise",
            {
                "trials": 24,
                "practice": 3,
                "participants_per_comparison": 25,
                "catch": {"trials": 3, "max_failed": 1},
                "questions": [{"name": "synchronisation"}, {"name": "emotion"}],
            },
        ),
        (
            "rating",
            {
                "participants": 90,
                "sets": [{"groups": 8}, {"groups": 8}],
                "questions": [{"name": "naturalness"}, {"name": "synchrony"}],
                "form": {"eligibility": [{"name": "adult"}, {"name": "senses"}]},
            },
        ),
        ("ranking", {"participants": 22, "ties": False, "blocks": [{"trials": 8}, {"trials": 12}]}),
        ("mismatch", {"questions": [{"name": "fit", "levels": 3}, {"name": "realism"}]}),
    ],
)
def test_each_template_follows_its_published_design(
    tmp_path: Path, template: str, published: dict[str, Any]
) -> None:
    made = new_study(tmp_path / "study.toml", template=template, name="study").model_dump()

    assert restricted(made, published) == published


def restricted(value: Any, like: Any) -> Any:
    """Return the keys of `value` that `like` has, at any depth."""
    if isinstance(like, dict):
        return {key: restricted(value[key], inner) for key, inner in like.items()}
    if isinstance(like, list):
        return [restricted(*pair) for pair in zip(value, like, strict=True)]
    return value


def leaves(value: Any, path: tuple[Any, ...] = ()) -> dict[tuple[Any, ...], str]:
    """Return every text within `value`, by its path; names are for programs."""
    if isinstance(value, str):
        return {} if path[-1] == "name" else {path: value}
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    return {at: text for key, each in inner for at, text in leaves(each, (*path, key)).items()}


@pytest.mark.parametrize("language", ["de", "ja"])
@pytest.mark.parametrize("template", [name for name in TEMPLATES if name not in ALIASES])
def test_a_translated_template_differs_only_in_its_language(
    tmp_path: Path, template: str, language: Language
) -> None:
    english = new_study(tmp_path / "en.toml", template=template, name="study")
    study = new_study(tmp_path / "own.toml", template=template, name="study", language=language)

    before, after = (leaves(read_texts(template, each)) for each in ("en", language))
    assert before.keys() == after.keys()
    assert [path for path in before if before[path] == after[path]] == []
    assert all(("{emotion}" in before[path]) is ("{emotion}" in after[path]) for path in before)
    assert study.page.language == language
    said: dict[str, Any] = {"title": ..., "questions": {"__all__": {"text", "labels", "reasons"}}}
    said["page"] = {"language", "consent"}
    said["form"] = {"eligibility": {"__all__": {"text", "choices", "eligible"}}}
    assert study.model_dump(exclude=said) == english.model_dump(exclude=said)


def test_the_chosen_settings_are_written_into_the_file(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    new_study(path, name="scott", title="T", reference="static", trials=6, language="ja")
    study = read_study(path)
    assert isinstance(study, PairwiseStudy)
    assert (study.name, study.title, study.reference, study.trials) == ("scott", "T", "static", 6)
    assert study.conditions["static"].generator == "static"
    assert study.conditions["mismatched"].source == "static"
    for name in ("ground_truth", "diffsheg"):
        # Motion without a generator is expected as files; few trials leave speech for practice.
        study = new_study(tmp_path / f"{name}.toml", name="s", reference=name, trials=2)
        assert isinstance(study, PairwiseStudy)
        assert (study.conditions[name].generator, study.practice) == (None, 1)


@pytest.mark.parametrize(
    ("framing", "second", "expected"),
    [
        (None, "Which face is more alive?", "face"),
        (None, "Which motion is more alive?", "upper_body"),
        (None, "Ignore the face, the lips and the mouth: which arms fit better?", "upper_body"),
        (None, "Ignoring the hands, which face is more alive?", "face"),
        (None, "Welche Bewegung ist unter diesem Gesichtspunkt besser?", "upper_body"),
        ("full_body", "Which face is more alive?", "full_body"),
    ],
)
def test_the_face_is_framed_if_all_questions_are_about_it(
    tmp_path: Path, framing: Framing | None, second: str, expected: str
) -> None:
    wording = {"fit": "Which lips fit better?", "realism": second}
    study = new_study(
        tmp_path / "s.toml", name="s", template="mismatch", framing=framing, wording=wording
    )

    assert study.video.framing == expected


def test_adding_a_condition_keeps_the_comments_and_reads_over_a_byte_order_mark(
    tmp_path: Path,
) -> None:
    path = tmp_path / "study.toml"
    new_study(path, name="s")
    comments = path.read_text().count("#")
    path.write_text(path.read_text(), "utf-8-sig")
    study = add_condition(path, "ground_truth")
    assert study.conditions["ground_truth"].generator is None
    assert path.read_text().count("#") == comments
    assert "[conditions.ground_truth]\n\n[catch]\n# Catch trials" in path.read_text()
    assert "ground_truth" in read_study(path).conditions


def test_one_study_can_compare_all_three_systems(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    study = new_study(path, template="three-systems", name="s", trials=15, participants=10)
    assert isinstance(study, PairwiseStudy)
    assert list(study.conditions) == [
        "ground_truth", "amuse", "diffsheg", "s2ue", "rule_based", "mismatched",
    ]  # fmt: skip
    assert study.has_recording and study.conditions["mismatched"].source == "ground_truth"
    assert [question.name for question in study.questions] == ["gestures", "face", "realism"]
    assert len(study.pairs) == 2 * (15 + 1)
    assert (study.trials, study.participants) == (15, 10)


def test_renamed_conditions_keep_the_templates_settings(tmp_path: Path) -> None:
    conditions = {"amuse": Condition(generator="static"), "b": Condition(generator="rule_based")}
    study = new_study(
        tmp_path / "study.toml", template="three-systems", name="s", conditions=conditions
    )
    assert list(study.rehearsal.strength) == ["amuse"]


def test_a_ranking_shows_the_reference_separately_if_its_template_says_so(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    study = new_study(path, template="ranking", name="s", reference="recorded")
    assert isinstance(study, RankingStudy)
    assert study.reference == "recorded"
    assert study.conditions["recorded"].generator is None
    assert "[conditions.ground_truth]" not in path.read_text()
    assert '"ground_truth".\nreference = "recorded"\n' in path.read_text()
    assert path.read_text().splitlines().count("[conditions.recorded]") == 1
