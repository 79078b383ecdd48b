"""DAFMS decks (1992): trees of rigid and flexible bodies."""
