from __future__ import annotations

from tools.code_size import code_lines, importers

MODULE = '''"""What it is for."""

import json  # read


def read(text: str) -> object:
    """Return what `text` says."""
    # nothing is checked
    return json.loads(
        text
    )


SPLIT = """two
lines"""
"""What it means."""
'''


def test_docstrings_comments_and_blank_lines_are_not_counted() -> None:
    assert code_lines(MODULE) == 1 + 4 + 2


def test_a_module_is_imported_by_name_and_through_its_package() -> None:
    sources = {
        "room": "",
        "room.one": "import json",
        "room.two": "from room import one",
        "room.three": "from room.one import json\nimport room.two",
    }
    assert importers(sources) == {"room": 1, "room.one": 2, "room.two": 1}
