from __future__ import annotations

import pytest
from flask import Flask, render_template_string

from studyapp.session.refusal import UnacceptableError
from studyapp.study.settings.presentation import Message
from studyapp.web.errors import note_and_explain
from studyapp.web.language import language_of, speak

NEXT = {"en": "Next", "de": "Weiter", "ja": "次へ"}


def speaking(code: str) -> Flask:
    app = Flask("test")
    speak(app, language_of(code))
    return app


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("en", "Questions 1, 2 about B and 3 are not answered yet. Please wait."),
        ("de", "Die Fragen 1, 2 zu B und 3 sind noch nicht beantwortet. Please wait."),
        ("ja", "質問1、2（B）、3にまだ回答していません。Please wait."),
    ],
)
def test_a_refusal_is_said_whole_with_its_list(code: str, message: str) -> None:
    about = Message("{number} about {letter}", number=2, letter="B")
    refusal = UnacceptableError(
        "Questions {numbers} are not answered yet.", "Please wait.", numbers=(1, about, 3)
    )

    with speaking(code).test_request_context():
        assert note_and_explain(refusal) == message


def test_what_stands_in_a_place_is_escaped_and_marks_in_a_text_are_not() -> None:
    with speaking("de").app_context():
        page = render_template_string(
            "{{ _('Questions or trouble? %(contact)s', contact='<b>') }}"
            "{{ _('<strong>Answer the question</strong> under them.') }}"
        )

    assert page == (
        "Fragen oder Probleme? &lt;b&gt;<strong>Beantworten Sie die Frage</strong> darunter."
    )
