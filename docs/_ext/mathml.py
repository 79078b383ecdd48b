"""Formulas as MathML, which browsers show without scripts and without a network."""

import re

from docutils import nodes
from latex2mathml.converter import convert

PARENTHESES = re.compile(r"<mo>&#x00028;</mo>(<mtable)(>.*?</mtable>)<mo>&#x00029;</mo>", re.DOTALL)

# Between two formulas of a line, which narrow screens show below each other; not that of an indented line.
GAP = re.compile(r"(?<=\S)\s*\\qquad")


def mathml(formula: str, display: str = "inline") -> str:
    """Return a formula as MathML; the style sheet draws the parentheses of its matrices.

    Without a font for mathematics, which few Linux systems have, browsers do not stretch parentheses.
    """
    return PARENTHESES.sub(r'\1 class="matrix"\2', convert(formula, display=display))


def _inline(translator, node):
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _block(translator, node):
    formulas = "".join(mathml(part, display="block") for part in GAP.split(node.astext()) if part.strip())
    translator.body.append(f'<div class="math formulas">{formulas}</div>')
    raise nodes.SkipNode


def _nothing(translator, node):
    pass


def setup(app):
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (_inline, _nothing), (_block, _nothing))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True}
