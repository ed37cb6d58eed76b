"""What Amazon's client raises becomes words, for a store of videos and for Mechanical Turk."""

import pytest
from botocore.exceptions import ClientError, NoCredentialsError

from motion.errors import InputError
from studyapp.boto_errors import as_input_errors

REFUSED = ClientError({"Error": {"Code": "AccessDenied", "Message": "Not yours."}}, "PutObject")
UNREACHED = (
    "here: the store cannot be asked to store a.mp4 ({}). Check the network, and that "
    "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY hold your keys."
)


@pytest.mark.parametrize(
    ("raised", "words"),
    [
        (REFUSED, "here: the store does not store a.mp4: Not yours. Correct it."),
        (
            ClientError({}, "PutObject"),
            "here: the store does not store a.mp4: it gives no reason. Correct it.",
        ),
        (NoCredentialsError(), UNREACHED.format("NoCredentialsError")),
        (ValueError("Invalid endpoint: x"), UNREACHED.format("ValueError")),
    ],
)
def test_refusals_and_missing_responses_are_distinguished(raised: Exception, words: str) -> None:
    with (
        pytest.raises(InputError) as error,
        as_input_errors(
            "the store", "store a.mp4", correct="Correct it", check="the network", where="here"
        ),
    ):
        raise raised

    assert str(error.value) == words
