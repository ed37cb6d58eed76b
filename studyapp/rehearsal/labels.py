"""The words that belong to a field or a button, as people and screen readers find them."""

from __future__ import annotations

from bs4 import BeautifulSoup, Tag


def has_label(soup: BeautifulSoup, control: Tag) -> bool:
    """Tell whether `control`, a field or button of the page `soup`, has words; hidden ones may not.

    They are its own (of a button), those around it or meant for it (of a field), or said of it.
    """
    kind = str(control.get("type", "")).lower()
    if kind == "hidden":
        return True
    if control.name == "button" and _words(control):
        return True
    if kind == "submit" and str(control.get("value", "")).strip():
        return True
    if str(control.get("aria-label", "")).strip():
        return True
    named = [soup.find(id=name) for name in str(control.get("aria-labelledby", "")).split() if name]
    around = control.find_parent("label")
    meant = soup.find("label", attrs={"for": control["id"]}) if control.has_attr("id") else None
    return any(_words(each) for each in (*named, around, meant) if isinstance(each, Tag))


def _words(tag: Tag) -> str:
    """Return what is written in a tag, the choices of a menu in it aside."""
    return "".join(
        text for text in tag.find_all(string=True) if text.find_parent("option") is None
    ).strip()
