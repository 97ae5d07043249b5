"""Formulas as MathML, which browsers draw themselves: no script, no font, no network."""

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging

from eom.checker.report.page import mathml

LOG = logging.getLogger(__name__)


def _convert(node: nodes.Node, display: bool) -> str:
    text = mathml(node.astext(), display=display)
    if not text.startswith("<math"):
        LOG.warning("a formula has no MathML: %s", node.astext(), location=node, type="formula")
    return text


def _inline(self: Any, node: nodes.Node) -> None:
    self.body.append(_convert(node, display=False))
    raise nodes.SkipNode


def _block(self: Any, node: nodes.Node) -> None:
    """A formula by itself may be wider than the page: its box scrolls, by keys also."""
    self.body.append('<div class="formula" tabindex="0" role="group" aria-label="formula">')
    self.body.append(f"{_convert(node, display=True)}</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Name the renderer ``mathml``."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline, None), block_renderers=(_block, None)
    )
    return {"parallel_read_safe": True, "parallel_write_safe": True}
