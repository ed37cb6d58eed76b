"""Unknown names in templates are errors, and LaTeX always compiles."""

import math
import re
from collections.abc import Callable
from dataclasses import replace

import pytest
from jinja2 import UndefinedError

from analysis.report import wording
from analysis.report.content import Cell, Table
from analysis.report.page import as_frame
from analysis.report.texts import LONGEST, as_latex, booktabs, paragraphs, table


def test_an_unknown_name_in_a_template_is_an_error() -> None:
    with pytest.raises(UndefinedError):
        paragraphs("plan.assumed", together=[])
    with pytest.raises(UndefinedError):
        table("exclusions", [()])


def test_a_line_break_in_a_name_does_not_end_the_paragraph() -> None:
    said = paragraphs("participants.stills", segment="s1", transcript="one\n\ntwo", missing=[])
    assert len(said) == 1
    assert said[0].endswith("The speech: “one two”")


def cells(*texts: str) -> tuple[Cell, ...]:
    return tuple(Cell(text=text) for text in texts)


TABLE = Table(
    caption="Answers in %.",
    header=("condition", "ours", "others", "n"),
    rows=(
        (
            Cell(text="ours_1"),
            Cell(text="54", best=True),
            Cell(text="34", second=True),
            *cells("9"),
        ),
        cells("a & b", "–", "−1 ± 2", "< .001"),
    ),
    groups=(("", 1), ("Emotion & speech", 2), ("", 1)),
    notes=("The larger one is bold.",),
)


def test_a_table_uses_booktabs_rules() -> None:
    lines = booktabs(TABLE).splitlines()
    assert lines[0].startswith(r"% Needs \usepackage{booktabs,graphicx}")
    assert r"\begin{tabular}{lrrr}" in lines
    assert r" & \multicolumn{2}{c}{Emotion \& speech} &  \\" in lines
    assert r"\cmidrule(lr){2-3}" in lines
    assert r"ours\_1 & \textbf{54} & \underline{34} & 9 \\" in lines
    assert r"a \& b & -- & $-$1 $\pm$ 2 & \textless{} .001 \\" in lines
    assert r"{\footnotesize The larger one is bold.\par}" in lines
    remark = r"\caption{{[}rehearsal{]} Answers in \%.}"
    assert remark in booktabs(TABLE, remark="[rehearsal]")


def test_a_tables_file_has_full_precision_and_unescaped_text() -> None:
    row = (Cell(text="ours"), Cell(text=".33", value=1 / 3), *cells("–", "9"))
    frame = as_frame(replace(TABLE, rows=(row,)))
    assert frame.columns.tolist() == [
        *("condition", "Emotion & speech ours", "Emotion & speech others", "n")
    ]
    assert frame.iloc[0].tolist() == ["ours", 0.3333333333, "–", "9"]


def test_long_tables_break_over_pages() -> None:
    text = booktabs(replace(TABLE, rows=TABLE.rows * LONGEST))
    assert r"\begin{longtable}{lrrr}" in text
    assert text.index(r"\endhead") < text.index(r"ours\_1")
    assert "longtable" in text.splitlines()[0]


@pytest.mark.parametrize("sign", [chr(k) for k in range(33, 127) if not chr(k).isalnum()])
def test_special_characters_in_names_are_escaped(sign: str) -> None:
    text = as_latex(f"a{sign}b")
    bare = re.sub(r"\\[a-z]+\{\}|\\[&%$#_{}]|\{[\[\]]\}|\$[^$]*\$", "", text)
    assert not set(bare) & set('\\&%$#_{}~^[]<>|"')


def test_every_environment_and_brace_is_closed() -> None:
    nasty = "".join(map(chr, range(32, 127)))
    table = replace(TABLE, caption=nasty, rows=(cells(nasty, *"abc"),), notes=(nasty,))
    for text in (booktabs(table), booktabs(replace(table, rows=table.rows * (LONGEST + 1)))):
        plain = re.sub(r"\\[{}]", "", text)
        assert plain.count("{") == plain.count("}")
        assert re.findall(r"\\begin\{(\w+)\}", text) == re.findall(r"\\end\{(\w+)\}", text)[::-1]


@pytest.mark.parametrize(
    ("formatted", "value", "text"),
    [
        (wording.share, 0.634, ".63"),
        (wording.share, -0.001, ".00"),
        (wording.share, math.nan, "–"),
        (wording.p_value, 0.0004, f"<{wording.NO_BREAK}.001"),
        (wording.p_value, 0.0996, ".10"),
        (wording.p_value, 0.999, "1"),
        (wording.p_value, math.nan, "–"),
        (wording.quantity, 0.01234, "0.0123"),
        (wording.quantity, -2.5, "−2.50"),
        (wording.quantity, 1e-15, "0"),
        (wording.number, -0.004, "0.00"),
    ],
)
def test_shares_p_values_and_quantities_have_sensible_digits(
    formatted: Callable[[float], str], value: float, text: str
) -> None:
    assert formatted(value) == text
