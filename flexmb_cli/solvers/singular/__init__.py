"""Singular configurations: finding, passing and naming them."""
