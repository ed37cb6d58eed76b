"""A small study, and the people who rehearse it."""

from __future__ import annotations

import pytest

from studyapp.definition.study import Study
from studyapp.rehearsal.population import Population, default_population


@pytest.fixture(scope="session")
def study() -> Study:
    return Study.model_validate(
        {
            "name": "tiny",
            "title": "A tiny study",
            "reference": "rule_based",
            "conditions": {
                "rule_based": {"generator": "rule_based"},
                "mismatched": {"generator": "mismatched", "source": "rule_based"},
                "static": {"generator": "static"},
                "brought": {},
            },
            "questions": [
                {"name": "rhythm", "title": "Rhythm", "text": "Which fits the rhythm better?"},
                {"name": "emotion", "title": "Emotion", "text": "Which shows {emotion} better?"},
            ],
            "page": {"consent": "I agree."},
        }
    )


@pytest.fixture(scope="session")
def population(study: Study) -> Population:
    return default_population(study)
