from __future__ import annotations

import pytest

from studyapp.researchers.interim.documents import Basis, Document


def test_a_document_is_read_as_it_was_written() -> None:
    basis = Basis(finished=2, planned=4, answers=24, answered=3, analysed=2)
    written = Document(basis=basis, rows=())

    assert Document.read(written.model_dump_json()) == written
    assert (basis.state.finished, basis.state.is_interim) == (2, True)


@pytest.mark.parametrize("text", ["", "{", '{"rows": []}', '{"basis": null, "more": 1}'])
def test_what_another_version_kept_is_none(text: str) -> None:
    assert Document.read(text) is None
