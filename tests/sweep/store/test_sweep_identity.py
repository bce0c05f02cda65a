"""What a store is refused for: everything that could change a bit."""

import pytest

import whirlmap
from whirlmap.sweep.store import fingerprint as identity


@pytest.fixture
def fresh():
    identity._program.cache_clear()
    yield
    identity._program.cache_clear()


@pytest.mark.usefixtures("fresh")
@pytest.mark.parametrize("library", identity.LIBRARIES)
def test_another_version_of_a_library_is_another_program(library, monkeypatch):
    system, version = whirlmap.load("duffing"), identity.package_version
    before = identity.kernel_hash(system, "dop853")
    identity._program.cache_clear()
    assert identity.kernel_hash(system, "dop853") == before
    identity._program.cache_clear()
    monkeypatch.setattr(identity, "package_version", lambda name: "other" if name == library else version(name))
    assert identity.kernel_hash(system, "dop853") != before


@pytest.mark.usefixtures("fresh")
def test_another_llvm_is_another_program(monkeypatch):
    system = whirlmap.load("duffing")
    before = identity.kernel_hash(system, "dop853")
    identity._program.cache_clear()
    monkeypatch.setattr("llvmlite.__version__", "other")
    assert identity.kernel_hash(system, "dop853") != before


def test_model_and_method_are_part_of_it():
    system = whirlmap.load("duffing")
    assert identity.kernel_hash(system, "dop853") != identity.kernel_hash(system, "rk4")
    assert identity.kernel_hash(system, "dop853") != identity.kernel_hash(whirlmap.load("pendulum"), "dop853")
    assert identity.kernel_hash(system, "dop853") == identity.kernel_hash(whirlmap.load("duffing", gamma=0.5), "dop853")
