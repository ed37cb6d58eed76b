"""Errors of Amazon's client, in plain words."""

from collections.abc import Iterator
from contextlib import contextmanager

from motion.errors import InputError


@contextmanager
def as_input_errors(
    service: str, action: str, *, correct: str, check: str, where: str = ""
) -> Iterator[None]:
    """Turn what boto3 raises into an `InputError`.

    Parameters
    ----------
    service : str
        The service, as the beginning of a sentence.
    action : str
        What the service is asked to do.
    correct : str
        What to do if it refuses.
    check : str
        What to check, beside the keys, if it cannot be reached.
    where : str
        The address of the service.
    """
    from botocore.exceptions import BotoCoreError, ClientError

    try:
        yield
    except ClientError as error:
        details = error.response.get("Error", {})
        reason = details.get("Message") or details.get("Code", "it gives no reason")
        raise InputError(
            f"{service} does not {action}: {reason}", where=where, remedy=correct
        ) from None
    except (BotoCoreError, ValueError) as error:  # the latter if the endpoint is not an address
        raise InputError(
            f"{service} cannot be asked to {action} ({type(error).__name__})",
            where=where,
            remedy=f"Check {check}, and that AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY hold "
            "your keys",
        ) from None
