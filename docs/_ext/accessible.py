"""What keyboards and screen readers need and the theme lacks: names of landmarks, ways to scroll."""

from pathlib import Path

from sphinx.application import Sphinx

CHANGES = (
    ('<aside class="sidebar-drawer">', '<aside class="sidebar-drawer" aria-label="Site">'),
    ('<aside class="toc-drawer">', '<aside class="toc-drawer" aria-label="Page">'),
    ('<aside class="toc-drawer no-toc">', '<aside class="toc-drawer no-toc" aria-label="Page">'),
    ("<pre>", '<pre tabindex="0">'),
    (
        '<div class="table-wrapper',
        '<div tabindex="0" role="group" aria-label="table" class="table-wrapper',
    ),
)
"""What stands on pages, and what is put in its place; what is there already is left alone."""


def complete(app: Sphinx, error: Exception | None) -> None:
    """Change the pages that were written."""
    if error is not None or app.builder.format != "html":
        return
    for path in sorted(Path(app.outdir).rglob("*.html")):
        text = path.read_text(encoding="utf-8")
        changed = text
        for old, new in CHANGES:
            changed = changed.replace(old, new)
        if changed != text:
            path.write_text(changed, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to the end of the build."""
    app.connect("build-finished", complete)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
