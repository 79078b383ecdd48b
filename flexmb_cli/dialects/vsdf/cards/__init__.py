"""The cards of a VSDF deck: one table of words, columns and meanings.

Vlasenko and Kasper (2008) typed their models into Maple; this deck is flexmb's own.  The
whole format is described for users in decks/vsdf/FORMAT.md.
"""

from .analysis import ANALYSIS_CARDS, SHAPES
from .bodies import BODY_CARDS
from .joints_and_loads import JOINT_AND_LOAD_CARDS

__all__ = ["BY_WORD", "CARDS", "DATA_WORDS", "END", "FINAL", "KNOWN_WORDS", "SHAPES", "STAR", "STOP"]
END, STAR, STOP = "END", "STAR", "STOP"
FINAL = (END, STAR, STOP)

# In the order of the dialogue.
CARDS = (*BODY_CARDS, *JOINT_AND_LOAD_CARDS, *ANALYSIS_CARDS)
BY_WORD = {card.word: card for card in CARDS}
KNOWN_WORDS = (*BY_WORD, *FINAL)
# Words that data cards begin with.
DATA_WORDS = tuple(word for card in CARDS if card.columns[0].letter == "A" for word in card.columns[0].words)
