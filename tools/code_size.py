"""The size of the product: ``make size`` writes the table at the head of CONTRIBUTING.md."""

import ast
import io
import tokenize
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from motion.files import write_text

ROOT: Final = Path(__file__).resolve().parents[1]
PAGE: Final = ROOT / "CONTRIBUTING.md"
PRODUCT: Final = ("motion", "training", "generators", "renderer", "analysis", "studyapp")
BEGIN: Final = "<!-- size -->"
END: Final = "<!-- end of size -->"
SMALL: Final = 60
"""Code lines below which a module with a single importer needs a justification."""

_LAYOUT: Final = {
    tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
    tokenize.ENDMARKER,
}  # fmt: skip


def code_lines(source: str) -> int:
    """Return the number of code lines in `source`, without docstrings, comments and blanks."""
    documented = {
        line
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    written = {
        line
        for token in tokenize.generate_tokens(io.StringIO(source).readline)
        if token.type not in _LAYOUT
        for line in range(token.start[0], token.end[0] + 1)
    }
    return len(written - documented)


def importers(sources: Mapping[str, str]) -> Counter[str]:
    """Return how many other modules import each of `sources`, by dotted name."""
    counted: Counter[str] = Counter()
    for name, source in sources.items():
        counted.update(
            imported for imported in set(_imported(source)) & sources.keys() if imported != name
        )
    return counted


def _imported(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def table() -> str:
    """Return the size of product and tests as a table in Markdown."""
    product = [path for path in _python_files(PRODUCT) if "migrations" not in path.parts]
    lines = {path: code_lines(path.read_text("utf-8")) for path in product}
    sources = {_module(path): path.read_text("utf-8") for path in product}
    read_by = importers(sources)
    single = sum(
        read_by[_module(path)] == 1 and lines[path] < SMALL
        for path in product
        if path.name != "__init__.py"
    )
    folder, files = Counter(path.parent for path in product).most_common(1)[0]
    longest = max(product, key=lambda path: len(path.read_text("utf-8").splitlines()))
    tests = sum(code_lines(path.read_text("utf-8")) for path in _python_files(("tests",)))
    rows = [
        ("product files, migrations not counted", f"{len(product):,}"),
        ("code lines of the product", f"{sum(lines.values()):,}"),
        ("code lines of the tests", f"{tests:,}"),
        ("widest folder", f"{files} files, `{folder.relative_to(ROOT)}`"),
        (f"single-importer modules of fewer than {SMALL} lines of code", f"{single:,}"),
        (
            "longest file",
            f"{len(longest.read_text('utf-8').splitlines()):,} lines, "
            f"`{longest.relative_to(ROOT)}`",
        ),
    ]
    return "\n".join(["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows)])


def _python_files(rooms: Sequence[str]) -> list[Path]:
    return sorted(path for room in rooms for path in (ROOT / room).rglob("*.py"))


def _module(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def main() -> None:
    """Print the table and write it into CONTRIBUTING.md."""
    before, _, rest = PAGE.read_text("utf-8").partition(BEGIN)
    written = table()
    write_text(PAGE, f"{before}{BEGIN}\n{written}\n{END}{rest.partition(END)[2]}")
    print(written)


if __name__ == "__main__":
    main()
