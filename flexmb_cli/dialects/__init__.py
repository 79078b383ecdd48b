"""The input languages: one folder each, and the table that recognises them."""
