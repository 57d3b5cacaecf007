"""The JSON Schemas, by a reader that is not ours: the tests of the program hold every record of every command to them."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from conftest import BASE, FILTER, SMALL

import voidwalk as vw

jsonschema: Any = pytest.importorskip("jsonschema")


def validator(form: str) -> Any:
    schema = vw.schema(form)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_the_records_of_a_run_keep_to_their_schemas(tmp_path: Path) -> None:
    vw.judge(BASE, FILTER, tmp_path / "run", density="dense", quick=True, settings=SMALL)
    for form in ("outcome", "manifest"):
        validator(form).validate(json.loads((tmp_path / "run" / f"{form}.json").read_text(encoding="utf-8")))
    record = json.loads((tmp_path / "run" / "outcome.json").read_text(encoding="utf-8"))
    required = vw.schema("outcome")["required"]
    assert isinstance(required, list) and {"format", "voidwalk", "model", "summary"} <= set(required)
    for field in required:
        less = copy.deepcopy(record)
        del less[field]
        assert not validator("outcome").is_valid(less), field
    del record["summary"][0]["eroded_mass_fraction"]["mean"]
    assert not validator("outcome").is_valid(record)


def test_a_walk_on_a_network_keeps_to_its_own() -> None:
    outcome = vw.walk(vw.Network.cubic([6, 6, 9]), 0.2, n_base=1000, replicates=2).outcome
    validator("network-walk").validate(outcome)


def test_an_unknown_form_is_refused() -> None:
    with pytest.raises(ValueError, match="name = outcom is not allowed; one of outcome, manifest"):
        vw.schema("outcom")
