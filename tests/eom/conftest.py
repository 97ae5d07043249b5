"""The default suite draws a quarter of the examples that the slow tests are run with."""

from hypothesis import settings

FEW = 25
"""Examples of a property in the default suite; Hypothesis' own number is 100."""


def pytest_configure(config):
    """Before modules are imported, as properties take the profile when they are decorated."""
    if config.getoption("markexpr") == "not slow" and not config.getoption("--hypothesis-profile"):
        settings.register_profile("few", settings.get_profile("same"), max_examples=FEW)
        settings.load_profile("few")
