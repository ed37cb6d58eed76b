"""A study below a path of its host: every address on every page begins with that path."""

import pytest

from motion.errors import InputError
from studyapp.researchers.links import first_owner_link
from studyapp.web.mounting import checked_prefix
from studyapp.web.site import site_of
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.taking_part_steps import SetClock

PREFIX = "/studies/one"
ADDRESSES = ("href", "src", "action", "data-address", "data-watched-url", "content")


def strays(page: PageReader) -> list[str]:
    """Return every address on the page that leads out of the study on its own host."""
    values = [str(tag.get(name, "")) for tag in page.soup.select("*") for name in ADDRESSES]
    return [each for each in values if each[:1] == "/" and not each.startswith(f"{PREFIX}/")]


def test_researchers_reach_every_page_below_the_path(serve: Serve, clock: SetClock) -> None:
    below = serve(prefix=f"{PREFIX}/")
    token = first_owner_link(site_of(below).database, clock)
    client = below.test_client()
    first = client.get(f"{PREFIX}/research/changes").location
    assert first == f"{PREFIX}/research/log-in"
    # Health checks come past the proxy too.
    assert client.get("/healthz").status_code == client.get(f"{PREFIX}/healthz").status_code == 200
    join = PageReader(client.get(f"{PREFIX}/research/join/{token}").text)
    fields = {"name": "Ada", "password": PASSWORD, "again": PASSWORD}
    code = join.value("main [name=form_code]", "value")
    joined = client.post(join.action, data={**fields, "form_code": code})
    assert joined.location == f"{PREFIX}/research/"
    assert f"Path={PREFIX}/research" in joined.headers["Set-Cookie"]

    to_visit, visited = [joined.location], set[str]()
    while to_visit:
        address = to_visit.pop().partition("#")[0]
        if address in visited or "/media/" in address:
            continue
        visited.add(address)
        answer = client.get(address, buffered=True)
        assert answer.status_code == 200, address
        if answer.mimetype == "text/html":
            page = PageReader(answer.text)
            assert strays(page) == [], address
            if "/preview/" not in address or address.endswith("/1/"):
                to_visit += [str(link["href"]) for link in page.soup.select("a[href]")]

    researched = {each.partition("?")[0].removeprefix(f"{PREFIX}/research/") for each in visited}
    assert {"", "study-sessions", "preview", "newcomers", "changes", "researchers"} <= researched


@pytest.mark.parametrize(
    "path", ["one", "/a b", "/a//b", "/../x", "/a/./b", "/a?b", "//host", "/é"]
)
def test_invalid_paths_are_refused(path: str) -> None:
    with pytest.raises(InputError, match="/studies/one"):
        checked_prefix(path)
    assert [checked_prefix(path) for path in ("", "/", "/a", "/a/b-1/")] == ["", "", "/a", "/a/b-1"]
