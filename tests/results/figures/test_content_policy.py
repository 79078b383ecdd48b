"""The content security policy of the report page: its own script, no network, no handlers in elements.

Content Security Policy level 3 (W3C, 2024), sections 3.3 and 6.7: a policy in the page holds for what
follows it.
"""

from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser

from tests.results.figures.test_report_page import page_on, spoil, write_result

DATA = "application/json"


class Loaded(HTMLParser):
    """What of a page a browser would run or fetch, in the order of the page."""

    def __init__(self, page):
        super().__init__(convert_charrefs=True)
        self.policy, self.before_policy, self.scripts, self.handlers, self.addresses = "", [], [], [], []
        self.within = False
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if given.get("http-equiv", "").lower() == "content-security-policy":
            self.policy = given["content"]
        elif not self.policy and tag not in ("html", "head", "meta"):
            self.before_policy.append(tag)
        self.handlers += [name for name in given if name.startswith("on")]
        self.addresses += [given[name] for name in ("src", "href", "action", "data") if name in given]
        self.within = tag == "script" and given.get("type") != DATA
        self.scripts += [""] * self.within

    def handle_endtag(self, tag):
        self.within = False

    def handle_data(self, text):
        if self.within:
            self.scripts[-1] += text


def test_the_policy_allows_the_page_s_own_script_and_nothing_else(tmp_path):
    for change in (lambda path: path, spoil):
        found = Loaded(page_on(change(write_result(tmp_path / "r.h5"))))
        rules = dict(rule.strip().split(" ", 1) for rule in found.policy.split(";"))
        digests = [b64encode(sha256(script.encode()).digest()).decode() for script in found.scripts]
        assert rules == {
            "default-src": "'none'",
            "script-src": " ".join(f"'sha256-{digest}'" for digest in digests),
            "style-src": "'unsafe-inline'",
        }
        assert len(digests) == 1
        assert (found.before_policy, found.handlers, found.addresses) == ([], [], [])
