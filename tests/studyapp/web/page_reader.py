"""Reading a participant's page as a browser would."""

from bs4 import BeautifulSoup, Tag


class PageReader:
    """One page: its next step, and what a trial page holds."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.soup = BeautifulSoup(text, "html.parser")

    def one(self, selector: str) -> Tag:
        tags = self.soup.select(selector)
        assert len(tags) == 1, f"{selector}: {len(tags)} on the page"
        return tags[0]

    def value(self, selector: str, attribute: str) -> str:
        return str(self.one(selector)[attribute])

    @property
    def action(self) -> str:
        """Where the answers of a trial, or the only form of another page, go."""
        form = self.soup.select_one("form#answers") or self.one("main form[method=post]")
        return str(form["action"])

    @property
    def trial(self) -> str:
        return self.value("#answers [name=trial]", "value")

    @property
    def heading(self) -> str:
        return self.one("h1").get_text(strip=True)

    def words(self, selector: str = "body") -> str:
        """Return the text of what `selector` chooses, with single blanks."""
        return " ".join(self.one(selector).get_text().split())

    def checked(self) -> dict[str, str]:
        return {str(radio["name"]): str(radio["value"]) for radio in self.soup.select("[checked]")}
