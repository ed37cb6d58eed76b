"""What Amazon's client says, in words for whoever runs a command."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from motion.errors import InputError


@contextmanager
def said_plainly(
    service: str, what: str, *, correct: str, check: str, where: str = ""
) -> Iterator[None]:
    """Turn what boto3 raises into an `InputError`.

    Parameters
    ----------
    service : str
        Who is asked, as the beginning of a sentence.
    what : str
        What it is asked to do.
    correct : str
        What to do where it refuses.
    check : str
        What to look at, beside the keys, where it cannot be asked at all.
    where : str
        Which of such services it is.
    """
    from botocore.exceptions import BotoCoreError, ClientError

    try:
        yield
    except ClientError as error:
        said = error.response.get("Error", {})
        why = said.get("Message") or said.get("Code", "it gives no reason")
        raise InputError(f"{service} does not {what}: {why}", where=where, remedy=correct) from None
    except (BotoCoreError, ValueError) as error:  # the latter of an endpoint that is not an address
        raise InputError(
            f"{service} cannot be asked to {what} ({type(error).__name__})",
            where=where,
            remedy=f"Check {check}, and that AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY hold "
            "your keys",
        ) from None
