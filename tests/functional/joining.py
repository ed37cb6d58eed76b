"""How a researcher joins in a real browser."""

from playwright.sync_api import Page

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.researchers.links import first_owner_link
from tests.functional.browsing import follow
from tests.support.researcher_accounts import PASSWORD

NAME = "Ada Lovelace"


def link_for_owner(address: str, database: Database) -> str:
    """Return the link with which the first owner of the study at `address` joins."""
    return f"{address}/research/join/{first_owner_link(database, Clock())}"


def join(page: Page, link: str) -> None:
    """Become `NAME` by a link."""
    page.goto(link)
    page.get_by_label("Your name").fill(NAME)
    for label in ("New password", "Repeat it"):
        page.get_by_label(label).fill(PASSWORD)
    follow(page.get_by_role("button", name="Join"))
