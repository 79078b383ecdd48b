"""Places where the browser may break file names in the text, and words that it must not break."""

import re

_WORD = re.compile(r'<span class="pre">([^<]*)</span>')
_STROKE = re.compile(r"(?<=\w)/")  # not the first one of a path
_TEST = re.compile(r"::|(?<=[a-z0-9])_(?=[a-z0-9])")  # a name of a test is a sentence
_IDENTIFIER = re.compile(r"<td><p>([A-Z]+-[0-9]{3})</p></td>")  # of a message
LONGEST_WHOLE = 28  # of an option or an identifier that is kept on one line, characters


def setup(app):
    """Mark the words of every page."""
    app.connect("html-page-context", _mark)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _mark(app, pagename, templatename, context, doctree):
    if "body" in context:
        body = _IDENTIFIER.sub(r'<td><p class="whole">\1</p></td>', context["body"])
        context["body"] = _WORD.sub(_marked, body)


def _marked(found):
    word = found[1]
    if "::" in word:
        marked = _STROKE.sub("/<wbr>", _TEST.sub(r"\g<0><wbr>", word))
        return f'<span class="pre">{marked}</span>'
    if "/" in word:
        return f'<span class="pre">{_STROKE.sub("/<wbr>", word)}</span>'
    return f'<span class="pre whole">{word}</span>' if len(word) <= LONGEST_WHOLE else found[0]
