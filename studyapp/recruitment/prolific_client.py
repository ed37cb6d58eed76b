"""Prolific's API, as far as a study needs it (docs.prolific.com/api-reference).

The token comes from the environment, and is only written into the header of requests to Prolific.
Requests that may be repeated are sent again when Prolific is busy or fails. Making a study may not
be repeated, unless Prolific says that it did nothing.
"""

import os
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final, Literal, Self, TypeVar

import httpx
from pydantic import AliasChoices, BaseModel, ConfigDict, Field, ValidationError

from motion.errors import InputError

API: Final = "https://api.prolific.com"
TOKEN: Final = "PROLIFIC_TOKEN"  # noqa: S105 - the variable's name
TOKEN_LETTERS: Final = re.compile(r"[\x21-\x7e]{8,500}")

SECONDS: Final = 30.0
"""How long an answer may take."""

TRIES: Final = 5
LONGEST_WAIT: Final = 60.0
BUSY: Final = 429
FAILING: Final = (500, 502, 503, 504)
UNAUTHORISED: Final = (401, 403)

PAGE_SIZE: Final = 100
MOST_PAGES: Final = 1000
AT_ONCE: Final = 100
"""Submissions approved by one request."""

Action = Literal["PUBLISH", "START", "PAUSE", "STOP"]

AFTER: Final[Mapping[Action, tuple[str, ...]]] = {
    "PUBLISH": ("PUBLISHING", "ACTIVE", "SCHEDULED"),
    "START": ("ACTIVE",),
    "PAUSE": ("PAUSED",),
    "STOP": ("AWAITING REVIEW", "COMPLETED"),
}
"""The statuses that a study may have after an action."""


class Listing(BaseModel):
    """One page of a list."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    results: list[object]
    meta: dict[str, Any] | None = None


class CompletionCode(BaseModel):
    """A code that participants may come back with, and what it stands for."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    code: str
    code_type: str


class ProlificStudy(BaseModel):
    """A study as Prolific knows it; fields that are not needed are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    id: str
    status: str
    internal_name: str | None = None
    total_available_places: int | None = None
    places_taken: int | None = None
    reward: int | None = None
    completion_codes: tuple[CompletionCode, ...] = ()


class Submission(BaseModel):
    """One participant's submission.

    Attributes
    ----------
    code : str or None
        The completion code that was entered.
    return_requested : str or None
        When the participant was asked to return it.
    """

    model_config = ConfigDict(extra="ignore", frozen=True)

    id: str
    participant: str = Field(validation_alias=AliasChoices("participant_id", "participant"))
    status: str
    code: str | None = Field(None, validation_alias=AliasChoices("study_code", "entered_code"))
    return_requested: str | None = None


Read = TypeVar("Read", bound=BaseModel)


class ProlificRefusedError(InputError):
    """Prolific understood a request and refused it."""


def prolific_token() -> str:
    """Return the token for Prolific's API.

    Raises
    ------
    InputError
        If the environment holds none; the message never holds a part of it.
    """
    token = os.environ.get(TOKEN, "").strip()
    if not TOKEN_LETTERS.fullmatch(token):
        raise InputError(
            f"the environment variable {TOKEN} "
            + ("holds no Prolific token" if token else "is not set"),
            remedy="Make a token on Prolific (Settings, API tokens), and put it there",
        )
    return token


class ProlificClient:
    """A researcher's access to Prolific; a context manager, because it holds connections.

    Parameters
    ----------
    token : str
        See `prolific_token`.
    address : str, optional
        Address of the API; Prolific's by default.
    wait : callable
        Waits so many seconds before another attempt.
    """

    def __init__(
        self, token: str, *, address: str | None = None, wait: Callable[[float], None] = time.sleep
    ) -> None:
        self._token = token
        self._wait = wait
        self._client = httpx.Client(
            base_url=f"{address or API}/api/v1/",
            headers={"Authorization": f"Token {token}"},
            timeout=SECONDS,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._client.close()

    def study(self, study: str) -> ProlificStudy:
        """Return the study with this id."""
        return _read(ProlificStudy, self._ask("GET", f"studies/{study}/"))

    def study_named(self, internal_name: str) -> ProlificStudy | None:
        """Return the researcher's study with this internal name, None if there is none."""
        for result in self._pages("studies/", {}):
            study = _read(ProlificStudy, result)
            if study.internal_name == internal_name:
                return study
        return None

    def create(self, draft: Mapping[str, Any]) -> ProlificStudy:
        """Make a draft, which costs nothing and is not visible until it is published."""
        return _read(ProlificStudy, self._ask("POST", "studies/", draft, repeatable=False))

    def move(self, study: str, action: Action) -> ProlificStudy:
        """Publish, start, pause or stop a study, unless it already is.

        Raises
        ------
        ProlificRefusedError
            If Prolific does not do it in the study's present status.
        """
        if (present := self.study(study)).status in AFTER[action]:
            return present
        try:
            moved = self._ask("POST", f"studies/{study}/transition/", {"action": action})
        except ProlificRefusedError:
            # An earlier attempt may have succeeded although its response was lost.
            if (present := self.study(study)).status in AFTER[action]:
                return present
            raise
        return _read(ProlificStudy, moved)

    def submissions(self, study: str) -> list[Submission]:
        """Return all submissions of a study."""
        results = self._pages("submissions/", {"study": study})
        submissions = [_read(Submission, result) for result in results]
        # One that comes meanwhile shifts the others, of which one is then on two pages.
        return list({each.id: each for each in submissions}.values())

    def approve(self, submissions: Sequence[str]) -> None:
        """Pay these submissions; paying one twice does nothing."""
        for start in range(0, len(submissions), AT_ONCE):
            batch = list(submissions[start : start + AT_ONCE])
            self._ask("POST", "submissions/bulk-approve/", {"submission_ids": batch})

    def request_return(self, submission: str, reason: str) -> None:
        """Ask a participant to return a submission, which is then neither paid nor rejected."""
        reasons = {"request_return_reasons": [reason]}
        self._ask("POST", f"submissions/{submission}/request-return/", reasons, repeatable=False)

    def _pages(self, path: str, query: Mapping[str, str]) -> Iterator[object]:
        """Yield the results of all pages."""
        for page in range(1, MOST_PAGES + 1):
            parameters = httpx.QueryParams(
                {**query, "page": str(page), "page_size": str(PAGE_SIZE)}
            )
            listing = _read(Listing, self._ask("GET", f"{path}?{parameters}"))
            yield from listing.results
            # A page after the last may be refused.
            count = (listing.meta or {}).get("count")
            if len(listing.results) < PAGE_SIZE or page * PAGE_SIZE == count:
                return

    def _ask(
        self, method: str, path: str, body: object = None, *, repeatable: bool = True
    ) -> object:
        """Return Prolific's answer; try again if that does no harm."""
        for attempt in range(1, TRIES + 1):
            problem, pause = "", 2.0 ** (attempt - 1)
            try:
                answer = self._client.request(method, path, json=body)
            except httpx.RequestError as error:
                problem, may_retry = type(error).__name__, repeatable
            else:
                if answer.is_success:
                    return _json_of(answer)
                is_failing = answer.status_code in FAILING
                may_retry = answer.status_code == BUSY or (repeatable and is_failing)
                if not may_retry and not is_failing:
                    raise self._refusal(answer)
                problem = f"status {answer.status_code}"
                pause = max(pause, _retry_after(answer))
            if not may_retry or attempt == TRIES:
                break
            self._wait(min(pause, LONGEST_WAIT))
        raise InputError(
            f"Prolific cannot be reached ({problem})",
            where=f"{method} {path.partition('?')[0]}",
            remedy="Try again later; the same command goes on where it stopped"
            if may_retry
            else "It may have been done: run the command again, which looks first",
        )

    def _refusal(self, answer: httpx.Response) -> InputError:
        where = f"{answer.request.method} {answer.request.url.path}"
        if answer.status_code in UNAUTHORISED:
            return InputError(
                f"Prolific does not accept the token in {TOKEN}",
                where=where,
                remedy="Make a new one on Prolific, and check that its account may do this",
            )
        reason = _reason_in(answer).replace(self._token, "…")
        return ProlificRefusedError(
            f"Prolific answered {answer.status_code}: {reason}",
            where=where,
            remedy="Correct what it names, and run the command again",
        )


def _json_of(answer: httpx.Response) -> object:
    if not answer.content:
        return {}
    try:
        return answer.json()
    except ValueError:
        return {}  # some answers are a sentence


def _read(model: type[Read], answer: object) -> Read:
    try:
        return model.model_validate(answer)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(
            f"Prolific's answer is not understood ({model.__name__}: {key} {first['msg']})",
            remedy="Its API may have changed: look on Prolific's own pages meanwhile",
        ) from None


def _reason_in(answer: httpx.Response) -> str:
    """Return what Prolific says of an error, shortened."""
    body = _json_of(answer)
    error = body.get("error", body) if isinstance(body, dict) else body
    if isinstance(error, dict):
        parts = (error.get("title"), error.get("detail"))
        error = ": ".join(str(part) for part in parts if part) or error
    return str(error)[:500] or "nothing more"


def _retry_after(answer: httpx.Response) -> float:
    """Return the seconds of ``Retry-After``; 0 if there is none, or it is a date."""
    seconds = answer.headers.get("Retry-After", "")
    return float(seconds) if seconds.isdecimal() and len(seconds) < len("100000") else 0.0
