"""A server that answers as Prolific's API does, and refuses requests of another shape."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from flask import Flask, abort, jsonify, request
from flask.typing import ResponseReturnValue

from tests.support.servers.local_server import listening

TOKEN = "stand-in-token-0123456789"  # noqa: S105

CODE_TYPES = {
    *("COMPLETED", "FAILED_ATTENTION_CHECK", "FOLLOW_UP_STUDY", "GIVE_BONUS"),
    *("INCOMPATIBLE_DEVICE", "NO_CONSENT", "OTHER", "FIXED_SCREENOUT"),
}
ACTIONS: dict[str, set[str]] = {
    "AUTOMATICALLY_APPROVE": set(),
    "MANUALLY_REVIEW": set(),
    "REQUEST_RETURN": {"return_reason"},
    "FIXED_SCREEN_OUT_PAYMENT": {"fixed_screen_out_reward", "slots"},
}
NEEDED = {
    *("name", "description", "external_study_url", "prolific_id_option", "completion_codes"),
    *("total_available_places", "estimated_completion_time", "reward"),
}
AFTER = {"PUBLISH": "ACTIVE", "START": "ACTIVE", "PAUSE": "PAUSED", "STOP": "AWAITING REVIEW"}
FROM = {
    "PUBLISH": {"UNPUBLISHED"},
    "START": {"PAUSED", "AWAITING REVIEW"},
    "PAUSE": {"ACTIVE"},
    "STOP": {"ACTIVE", "PAUSED"},
}
MOST_BY_PAGE = 100


@dataclass
class StandIn:
    """The server's data, and its requests.

    Attributes
    ----------
    troubles : list of int
        Statuses with which the next requests are answered before anything is done.
    lost_answers : list of int
        Statuses with which the next requests are answered after everything is done.
    """

    studies: dict[str, dict[str, Any]] = field(default_factory=dict)
    submissions: list[dict[str, Any]] = field(default_factory=list)
    returns: dict[str, list[str]] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)
    troubles: list[int] = field(default_factory=list)
    lost_answers: list[int] = field(default_factory=list)
    retry_after: str | None = None
    address: str = ""

    def add_submission(self, name: str, status: str, code: str | None, **more: Any) -> None:
        self.submissions.append(
            {
                "id": f"submission-{name}",
                "participant_id": name,
                "status": status,
                "study_code": code,
                "started_at": "2026-05-04T00:00:00Z",
                "is_complete": code is not None,
                "return_requested": None,
                "strange_new_key": {"of": "theirs"},
                **more,
            }
        )

    def app(self) -> Flask:
        app = Flask("prolific-stand-in")
        app.before_request(self._check)
        app.after_request(self._lose)
        for rule, methods, view in (
            ("/studies/", ["GET"], self._list_studies),
            ("/studies/", ["POST"], self._create),
            ("/studies/<study>/", ["GET"], self._study),
            ("/studies/<study>/transition/", ["POST"], self._move),
            ("/submissions/", ["GET"], self._list_submissions),
            ("/submissions/bulk-approve/", ["POST"], self._approve),
            ("/submissions/<submission>/request-return/", ["POST"], self._return),
        ):
            name = f"{methods[0]} {rule}"
            app.add_url_rule(f"/api/v1{rule}", name, view, methods=methods)
        app.register_error_handler(400, _refuse)
        return app

    def _check(self) -> ResponseReturnValue | None:
        self.asked.append(f"{request.method} {request.full_path.rstrip('?')}")
        if request.headers.get("Authorization") != f"Token {TOKEN}":
            return jsonify(error={"status": 401, "title": "No", "detail": "bad token"}), 401
        if self.troubles:
            headers = {"Retry-After": self.retry_after} if self.retry_after else {}
            return "busy", self.troubles.pop(0), headers
        return None

    def _lose(self, answer: Any) -> Any:
        if self.lost_answers and request.method != "GET":
            answer.status_code = self.lost_answers.pop(0)
            answer.set_data("lost")
        return answer

    def _list_studies(self) -> ResponseReturnValue:
        return _page(list(self.studies.values()))

    def _create(self) -> ResponseReturnValue:
        sent = request.get_json()
        _require(not NEEDED - set(sent), f"missing {NEEDED - set(sent)}")
        _require(sent["external_study_url"].startswith("https://"), "external_study_url")
        _require(sent["prolific_id_option"] in ("question", "url_parameters"), "id option")
        codes = sent["completion_codes"]
        _require(len({code["code"] for code in codes}) == len(codes), "codes must be unique")
        for code in codes:
            _require(code["code_type"] in CODE_TYPES, "code_type")
            _require(code["actor"] in ("participant", "researcher"), "actor")
            for action in code["actions"]:
                wanted = ACTIONS[action["action"]]
                _require(set(action) == wanted | {"action"}, f"action {action}")
        for key in ("total_available_places", "estimated_completion_time", "reward"):
            _require(isinstance(sent[key], int) and sent[key] > 0, key)
        made = {**sent, "id": f"{len(self.studies) + 1:024x}", "status": "UNPUBLISHED"}
        self.studies[made["id"]] = {**made, "places_taken": 0}
        return jsonify(self.studies[made["id"]]), 201

    def _study(self, study: str) -> ResponseReturnValue:
        return jsonify(self.studies[study]) if study in self.studies else abort(404)

    def _move(self, study: str) -> ResponseReturnValue:
        action, known = request.get_json()["action"], self.studies[study]
        _require(known["status"] in FROM[action], f"{action} from {known['status']}")
        known["status"] = AFTER[action]
        return jsonify(known)

    def _list_submissions(self) -> ResponseReturnValue:
        _require(request.args.get("study") in self.studies, "study")
        return _page(self.submissions)

    def _approve(self) -> ResponseReturnValue:
        sent = request.get_json()
        _require(set(sent) == {"submission_ids"} and len(sent["submission_ids"]) > 0, "shape")
        for each in self.submissions:
            if each["id"] in sent["submission_ids"]:
                each["status"] = "APPROVED"
        return jsonify("The request to bulk approve has been made successfully."), 200

    def _return(self, submission: str) -> ResponseReturnValue:
        reasons = request.get_json()["request_return_reasons"]
        _require(isinstance(reasons, list) and all(isinstance(r, str) for r in reasons), "shape")
        self.returns.setdefault(submission, []).extend(reasons)
        return jsonify(id=submission, return_requested="2026-05-04T00:00:00Z")


def _page(everything: list[dict[str, Any]]) -> ResponseReturnValue:
    page, size = (int(request.args[key]) for key in ("page", "page_size"))
    _require(1 <= size <= MOST_BY_PAGE, "page_size")
    _require(page == 1 or (page - 1) * size < len(everything), "there is no such page")
    return jsonify(
        results=everything[(page - 1) * size : page * size], meta={"count": len(everything)}
    )


def _require(fine: bool, what: str) -> None:
    if not fine:
        abort(400, description=what)


def _refuse(error: Any) -> ResponseReturnValue:
    problem = {"status": 400, "title": "Bad request", "detail": error.description}
    return jsonify(error=problem), 400


@contextmanager
def served(stand_in: StandIn) -> Iterator[StandIn]:
    """Answer at an address of this machine."""
    with listening(stand_in.app()) as stand_in.address:
        yield stand_in
