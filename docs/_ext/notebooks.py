"""The notebooks of the repository as pages: copied beside the pages, with the outputs they keep."""

from pathlib import Path

from sphinx.application import Sphinx

SOURCE = Path(__file__).parents[2] / "notebooks"


def copy(app: Sphinx) -> None:
    """Copy what has changed, and remove what is gone."""
    folder = Path(app.srcdir) / "notebooks"
    folder.mkdir(exist_ok=True)
    wanted = {path.name: path.read_bytes() for path in sorted(SOURCE.glob("*.ipynb"))}
    for path in folder.glob("*.ipynb"):
        if path.name not in wanted:
            path.unlink()
    for name, content in wanted.items():
        path = folder / name
        if not path.is_file() or path.read_bytes() != content:
            path.write_bytes(content)


def setup(app: Sphinx) -> dict[str, bool]:
    """Copy before pages are looked for."""
    app.connect("builder-inited", copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
