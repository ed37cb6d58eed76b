import re
from importlib import import_module
from pathlib import Path

TABLES = (Path(__file__).parents[2] / "docs" / "statistics.md").read_text("utf-8")


def test_every_function_named_in_the_document_exists_and_is_documented() -> None:
    module = None
    found = 0
    for row in (line for line in TABLES.splitlines() if line.startswith("| ")):
        for name in re.findall(r"`([A-Za-z_.0-9]+)`", row.split("|")[2]):
            if "." in name:
                path, _, name = name.rpartition(".")
                module = import_module(f"analysis.{path}")
            assert getattr(module, name).__doc__, name
            found += 1
    assert found > 40
