"""What all tests share: the fixture and the option of the validation page."""

pytest_plugins = ["tests.validation.plugin"]
