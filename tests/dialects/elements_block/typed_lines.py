"""The lines of a deck's blocks as they are typed in `flexmb new`."""

from flexmb_cli.dialects.elements_block.text import begins_block, statements, uncommented


def typed_lines(deck):
    """Each line of the blocks, continued ones in one piece."""
    lines, found = deck.source.lines, []
    for n, line in enumerate(lines, 1):
        if begins_block(line):
            for words, _ in statements(uncommented(lines, n), n + 1):
                found += [" ".join(word.text for word in words)] if words else []
    return found
