"""Formulas as MathML, which browsers show without scripts and without a network."""

from docutils import nodes
from latex2mathml.converter import convert


def _inline(translator, node):
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(translator, node):
    translator.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def _nothing(translator, node):
    pass


def setup(app):
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (_inline, _nothing), (_block, _nothing))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True}
