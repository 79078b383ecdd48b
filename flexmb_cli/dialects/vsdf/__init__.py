"""VSDF decks: finite-element bodies in floating frames (VSDFlex, 2008)."""
