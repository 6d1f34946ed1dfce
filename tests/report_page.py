"""A report's page as a reader of its source has it."""

import re
from html.parser import HTMLParser

_ALONE = {"meta", "br", "img", "link", "hr", "input"}


def without_pictures(path):
    """The page without its pictures, whose letters mean nothing."""
    return re.sub("<svg.*?</svg>", "", path.read_text(), flags=re.DOTALL)


class Page(HTMLParser):
    """A page's elements: each has its tag, its attributes and all text inside it.

    Tags that are not closed, or closed in another order, are an error.
    """

    def __init__(self, path):
        super().__init__()
        self.elements = []
        self._open = []
        self.feed(path.read_text())
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        element = {"tag": tag, "text": "", **dict(attrs)}
        self.elements.append(element)
        for each in self._open:
            each.setdefault("inside", []).append(element)
        if tag not in _ALONE:
            self._open.append(element)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in _ALONE:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        assert self._open.pop()["tag"] == tag

    def handle_data(self, data):
        for each in self._open:
            each["text"] += data

    def all(self, tag, name=None):
        """Elements of a tag, and of a class if one is given."""
        return [
            each
            for each in self.elements
            if each["tag"] == tag and (name is None or name in each.get("class", "").split())
        ]

    @property
    def headline(self):
        (found,) = self.all("p", "headline")
        return found["text"]
