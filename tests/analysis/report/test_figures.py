from __future__ import annotations

import re

import pytest
from bs4 import BeautifulSoup
from matplotlib.figure import Figure

from analysis.report.emotion_figure import emotion_figure
from analysis.report.emotion_section import emotion_section
from analysis.report.findings import find
from analysis.report.preference_figure import preference_figure
from analysis.report.svg import inline_svg


def drawn(svg):
    return BeautifulSoup(svg, "html.parser").svg


@pytest.fixture(scope="module")
def findings():
    return {}


@pytest.fixture
def found(simulated_study, findings):
    """Return the findings of one study, made once."""
    if not findings:
        inputs = simulated_study(participants=8, segments=16).inputs()
        findings["inputs"], findings["found"] = inputs, find(inputs)
    return findings["found"]


def test_every_part_of_every_bar_tells_its_count(found):
    svg = drawn(preference_figure(found.preferences, ["emotion", "synchronisation"], mark=""))
    hints = [title.get_text() for title in svg("title")]
    expected = {
        f"{number} of {p.counts.total} answers"
        for p in found.preferences
        for number in p.counts.levels
    }
    assert len(hints) == 4 * 5
    assert {re.search(r": (.* answers)", hint).group(1) for hint in hints} == expected


def test_bars_are_as_wide_as_their_share_and_centred_on_no_difference(found):
    svg = drawn(preference_figure(found.preferences, ["emotion", "synchronisation"], mark=""))
    preference = next(p for p in found.preferences if p.question == "emotion")
    order = sorted(
        (p for p in found.preferences if p.question == "emotion"),
        key=lambda p: -p.win_share.estimate,
    )
    row = order.index(preference)
    edges = []
    for level in range(5):
        path = svg.find(id=f"preferences-bar0-{row}-{level}").path["d"]
        x = [float(number) for number in re.findall(r"[ML] ([\d.]+)", path)]
        edges.append((min(x), max(x)))
    widths = [right - left for left, right in edges]
    scale = sum(widths) / 100
    assert [width / scale for width in widths] == pytest.approx(
        preference.counts.percentages, abs=0.01
    )
    zero_lines = [
        float(m) for m in re.findall(r"M ([\d.]+) [\d.]+ \nL \1 ", str(svg).replace("\r", ""))
    ]
    middle = sum(edges[2]) / 2
    assert min(abs(middle - line) for line in zero_lines) < 0.01


def test_rows_are_sorted_by_win_share_and_numbers_stand_beside(found):
    svg = drawn(preference_figure(found.preferences, ["emotion", "synchronisation"], mark=""))
    texts = [text.get_text() for text in svg("text")]
    shares = {p.other: p.win_share.estimate for p in found.preferences if p.question == "emotion"}
    best = max(shares, key=shares.get)
    worst = min(shares, key=shares.get)
    assert texts.index(best) < texts.index(worst)
    assert f"{shares[best]:.2f}"[1:] in texts


def test_long_names_are_shortened_and_say_so(simulated_study):
    study = simulated_study(
        participants=3,
        segments=4,
        reference="a_reference_with_a_name_of_many_words",
        effects={"another_condition_with_a_name_of_many_words": 0.5},
    )
    found = find(study.inputs())
    svg = drawn(preference_figure(found.preferences, ["emotion"], mark=""))
    texts = [text.get_text() for text in svg("text")]
    assert "clearly a reference with a…" in texts
    assert "← prefer a reference… · % · prefer the other →" in texts
    assert "condition with …" in texts
    assert max(map(len, texts)) < 55


def test_one_emotion_is_said_to_repeat_all_of_them(simulated_study):
    study = simulated_study(participants=5, segments=4)
    answers = study.responses().assign(emotion="anger")
    inputs = study.inputs(responses=answers)
    said = emotion_section(inputs, find(inputs), "").paragraphs[0]
    assert said.startswith("All segments carry one emotion, anger, so both rows")


def test_a_mark_stays_with_the_figure(found):
    svg = drawn(preference_figure(found.preferences, ["emotion"], mark="Rehearsal: nobody"))
    assert "Rehearsal: nobody" in svg.get_text()


def test_the_forest_names_every_emotion_and_its_segments(found):
    overall = [p for p in found.preferences if p.other == "static"]
    within = [p for p in found.emotions if p.other == "static"]
    segments = [s for s in found.segments if s.comparison == overall[0].comparison]
    svg = drawn(emotion_figure(within, overall, segments, name="e", mark=""))
    hints = [title.get_text() for title in svg("title")]
    assert len(hints) == 2 * (8 + 1)
    assert sum("2 segments" in hint for hint in hints) == 16
    assert sum(hint.startswith("all emotions") for hint in hints) == 2


def test_few_segments_are_called_descriptive(found, findings, simulated_study):
    section = emotion_section(findings["inputs"], found, "")
    assert "(descriptive)" in section.heading
    assert "tick below for each segment" in section.pictures[0].caption
    single = simulated_study(participants=5, segments=8).inputs()
    assert "tick" not in emotion_section(single, find(single), "").pictures[0].caption


def test_an_inline_figure_has_ids_of_its_own_and_no_date():
    def draw(name):
        figure = Figure(figsize=(2, 1))
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1], gid="line")
        axes.set_title("a < b & c")
        return str(inline_svg(figure, name=name, alt='say "hi"', hints={"line": "1 < 2"}))

    first = draw("one")
    assert first == draw("one")
    ids = [set(re.findall(r'id="([^"]+)"', draw(name))) for name in ("one", "two")]
    assert not ids[0] & ids[1]
    assert all(each.startswith("one-") for each in ids[0])
    assert "<title>1 &lt; 2</title>" in first
    assert 'aria-label="say &#34;hi&#34;"' in first
    assert "a &lt; b &amp; c" in first
    assert "dc:date" not in first
