"""Contrast of the look's colours, light and dark (WCAG 2.2, level AA)."""

import re
from pathlib import Path

import pytest

STATIC = Path(__file__).parents[3] / "studyapp" / "web" / "static"
STYLES = sorted(STATIC.glob("*.css"))
TEXT, EDGE = 4.5, 3.0
"""The least contrast of text (1.4.3), and of the edges of controls and focus (1.4.11)."""

Colours = dict[str, str]


def looks() -> list[Colours]:
    """Return the colours of the light look and of researchers' dark one, by their names."""
    text = "".join((STATIC / f"{name}.css").read_text("utf-8") for name in ("style", "research"))
    roots = re.findall(r":root \{(.*?)\}", text, re.DOTALL)
    return [dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", root)) for root in roots]


def luminance(colour: str) -> float:
    shares = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    red, green, blue = (s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    darker, lighter = sorted((luminance(one), luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


@pytest.mark.parametrize("look", looks(), ids=["light", "dark"])
@pytest.mark.parametrize(
    ("front", "behind", "least"),
    [
        ("warning", "flash", TEXT),
        *[("edge", behind, EDGE) for behind in ("background", "paper", "raised")],
    ],
)
def test_labels_and_marks_contrast_with_the_background(
    look: Colours, front: str, behind: str, least: float
) -> None:
    assert contrast(look[front], look[behind]) >= least


@pytest.mark.parametrize("style", STYLES, ids=lambda path: path.name)
def test_every_colour_is_defined_by_the_theme(style: Path) -> None:
    text = re.sub(r":root \{.*?\}", "", style.read_text("utf-8"), flags=re.DOTALL)

    assert re.findall(r"#[0-9a-fA-F]{3,8}\s*[;,)]", text) == []
    assert set(re.findall(r"var\(--([a-z-]+)", text)) - looks()[0].keys() <= {"columns", "shade"}


@pytest.mark.parametrize("style", STYLES, ids=lambda path: path.name)
def test_the_text_size_chosen_in_the_browser_is_respected(style: Path) -> None:
    assert not re.search(r"\bfont(-size)?:[^;]*\dpx", style.read_text("utf-8"))


def test_reduced_motion_is_respected() -> None:
    for style in STYLES:
        text = style.read_text("utf-8")
        calm = re.sub(
            r"@media \(prefers-reduced-motion: no-preference\) \{.*?\n\}", "", text, flags=re.DOTALL
        )
        assert not re.search(r"\b(animation|transition)\b", calm)
