"""Provenance: complete, of types that files can hold, and the same for the same thing."""

import json
from datetime import datetime
from fractions import Fraction

import numpy as np

from whirlmap.results.provenance import PASSING, Pieces, model_hash, provenance

PIECES = Pieces(
    model="duffing",
    model_hash="abc",
    case="duffing",
    case_hash="def",
    parameters={
        "gamma": {"value": np.float64(0.1), "unit": "1", "source": "assumed: test"},
        "r": {"value": Fraction(1, 8)},
    },
    switches={"arc": "fixed"},
    citations=("holmes1979",),
)


def test_attributes_are_text_and_numbers():
    made = provenance(
        PIECES, method="rk4", steps_per_period=100, seed=7, settings={"rtol": 1e-9}, citations=["kutta1901"]
    )
    assert all(type(value) in (str, int, float) for value in made.values())
    assert json.loads(made["parameters"])["gamma"]["value"] == 0.1
    assert json.loads(made["parameters"])["r"]["value"] == "1/8"
    assert json.loads(made["settings"]) == {"rtol": 1e-9}
    assert made["citations"] == "holmes1979 kutta1901"
    assert made["whirlmap_version"]
    assert datetime.fromisoformat(made["date"]).utcoffset().total_seconds() == 0


def test_what_was_not_used_is_left_out():
    made = provenance(PIECES)
    assert not {"method", "seed", "steps_per_period", "settings"} & set(made)


def test_the_command_can_be_pasted_into_a_shell():
    made = provenance(PIECES, command=["/opt/bin/whirlmap", "simulate", "duffing", "--set", "speed=1500 rpm"])
    assert made["command"] == "whirlmap simulate duffing --set 'speed=1500 rpm'"
    assert provenance(PIECES, command="from Python")["command"] == "from Python"


def test_two_runs_differ_in_date_and_command_only():
    one, other = provenance(PIECES, command="a"), provenance(PIECES, command="b")
    assert {k: v for k, v in one.items() if k not in PASSING} == {
        k: v for k, v in other.items() if k not in PASSING
    }


def test_the_models_hash_sees_every_expression_and_its_name():
    base = model_hash([("x", "v"), ("v", "-x")])
    assert base == model_hash([("x", "v"), ("v", "-x")])
    assert base != model_hash([("x", "v"), ("v", "-2*x")])
    assert base != model_hash([("y", "v"), ("v", "-x")])
    assert base != model_hash([("v", "-x"), ("x", "v")])
