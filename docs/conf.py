"""Settings of the documentation site: `python -m sphinx -W -n docs build/site`."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE / "_ext")]

import eom  # noqa: E402 - the package of this checkout

project = "eom"
author = "The eom developers"
project_copyright = "the eom developers, BSD-3-Clause"
version = release = eom.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "accessible",
    "command_line",
    "docstrings",
    "formulas",
    "made",
    "notebooks",
    "scene_files",
    "shown_tables",
]
exclude_patterns = ["_ext"]
nb_execution_mode = "off"  # notebooks keep their outputs; tests run them
nb_ipywidgets_js = {}  # nothing is fetched when a page is read
nb_render_markdown_format = "myst"
myst_enable_extensions = ["amsmath", "attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
html_math_renderer = "mathml"

default_role = "py:obj"  # names in single backticks, as docstrings have them
autosummary_generate = False
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_format = "short"
autodoc_class_signature = "mixed"
autodoc_type_aliases = {
    name: name
    for name in (
        "AnyScene",
        "Array",
        "ArrayLike",
        "Expr",
        "InputsGiven",
        "Many",
        "Matrix",
        "Values",
    )
}  # each is explained in reference/types.md; others are written out
python_use_unqualified_type_names = True
toc_object_entries_show_parents = "hide"
nitpick_ignore_regex = [("py:.*", ".*")]  # types of other packages have no page here

html_theme = "furo"
html_title = "eom"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
html_last_updated_fmt = None
html_baseurl = ""
