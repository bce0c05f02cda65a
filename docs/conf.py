"""Sphinx: how `make docs` builds the site of these pages, of the docstrings and of the gallery, without a network."""

import sys
from importlib.resources import files
from pathlib import Path

import whirlmap

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

project = "whirlmap"
author = "the authors of whirlmap"
version = release = whirlmap.__version__
html_show_copyright = False

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx.ext.mathjax",
    "sphinxcontrib.bibtex",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    # of this site, in _ext
    "docstring_citations",
    "generated_parts",
    "repository_links",
    "site_checks",
]
html_extra_path = ["llms.txt"]
exclude_patterns = ["_templates", "gallery"]
templates_path = ["_templates"]
suppress_warnings = [
    "bibtex.missing_field",  # references.bib leaves out what is not known for certain
]
nitpicky = False  # types in docstrings are words, such as "array, shape (time, state)"
default_role = "py:obj"  # `name` in a docstring: a link where it is a public name
smartquotes = False  # options begin with two hyphens, and quotes are typed as they stand
modindex_common_prefix = ["whirlmap."]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 4
myst_links_external_new_tab = False

autosummary_generate = True
autosummary_imported_members = False
autodoc_typehints = "none"  # the docstring says them, with shapes and units
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True  # attributes as one list, as parameters are
viewcode_line_numbers = True

bibtex_bibfiles = ["../src/whirlmap/references.bib"]
bibtex_reference_style = "author_year"
bibtex_default_style = "plain"

#: One file with its fonts inside, which asks for nothing else (the package carries MathJax 3's own release).
MATHJAX = Path(str(files("mathjax"))) / "static" / "mathjax" / "es5" / "tex-svg.js"
mathjax_path = MATHJAX.name

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": r"/plot_",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("figure_scraper.scrape",),
    "reset_modules": (),
    "backreferences_dir": "reference/generated/examples",
    "doc_module": ("whirlmap",),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "write_computation_times": False,  # its table is fetched from outside
    "plot_gallery": True,
    "min_reported_time": 0,
    "capture_repr": ("_repr_html_", "__repr__"),
}

html_theme = "pydata_sphinx_theme"
html_title = "whirlmap"
html_static_path = ["_static", str(MATHJAX)]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_theme_options = {
    "navbar_end": ["theme-switcher"],
    "show_prev_next": True,
    "navigation_depth": 3,
    "show_toc_level": 2,
    "footer_start": ["sphinx-version"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "pygments_light_style": "tango",
    "pygments_dark_style": "monokai",
}
