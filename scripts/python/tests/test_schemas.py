"""The JSON Schemas: every record that a command writes keeps to its own, and a field that is gone does not."""

from __future__ import annotations

import copy
import json
import subprocess
from pathlib import Path
from typing import Any, Dict, Iterator, List, Tuple

import pytest

import voidwalk as vw

jsonschema: Any = pytest.importorskip("jsonschema")

BASE, FILTER = ([0.06, 0.12, 0.3], [0.0, 50.0, 100.0]), ([0.5, 1.0, 2.0], [0.0, 50.0, 100.0])
SMALL = {"network.nx": 8, "network.ny": 8, "network.nz": 12}


def validator(form: str) -> Any:
    schema = vw.schema(form)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def keeps(record: Dict[str, Any]) -> None:
    """A record keeps to the schema that its beginning names, and says nothing that this does not know."""
    form = str(record["format"]).removeprefix("voidwalk-").rsplit("/", 1)[0]
    errors = [f"{list(error.path)}: {error.message}" for error in validator(form).iter_errors(record)]
    assert not errors, errors
    known = vw.schema(form)["properties"]
    assert isinstance(known, dict) and set(record) <= set(known), set(record) - set(known)


def records(folder: Path) -> Iterator[Tuple[Path, Dict[str, Any]]]:
    for path in sorted(folder.rglob("*.json")):
        record = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(record, dict) and "format" in record:
            yield path, record


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of every kind that Python's calls make."""
    place = tmp_path_factory.mktemp("folders")
    options: Dict[str, Any] = dict(density="dense", quick=True, settings=SMALL)
    vw.judge(BASE, FILTER, place / "run", **options)
    vw.judge(BASE, FILTER, place / "studied", density="dense", replicates=2, settings=SMALL)
    across = {"network.nx": 8, "network.ny": 8}
    vw.boundary(BASE, FILTER, place / "searched", thickness="10layers", replicates=2, settings=across)
    vw.percolation([4, 6, 8, 10], realisations=4, out=place / "percolated")
    sets = {"replicates": 2, "network.nx": 6, "network.ny": 6, "network.nz": 9, "record.sensitivity": []}
    factors = [{"name": "cu", "setting": "base.cu", "values": [1.5, 2.0]}]
    plan = {"title": "two bases", "set": {**sets, "filter.curve": "cu1.5-loose"}, "factor": factors}
    vw.campaign(plan, place / "campaign")
    return place


def test_every_record_keeps_to_its_schema(folders: Path) -> None:
    found: List[str] = []
    for path, record in records(folders):
        keeps(record)
        found.append(str(record["format"]))
    for form in ("outcome", "manifest", "boundary", "percolation", "campaign", "case"):
        assert f"voidwalk-{form}/1" in found, (form, set(found))


def test_what_the_program_prints_keeps_to_its_schema(program: str, folders: Path, tmp_path: Path) -> None:
    def printed(*words: str) -> Dict[str, Any]:
        done = subprocess.run([program, *words], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        said: Dict[str, Any] = json.loads(done.stdout)
        return said

    for name, (sizes, percents) in {"base": BASE, "filter": FILTER}.items():
        rows = "".join(f"{size},{percent}\n" for size, percent in zip(sizes, percents))
        (tmp_path / f"{name}.csv").write_text("opening_mm,percent_finer\n" + rows)
    keeps(printed("soil", "base.csv", "--json"))
    keeps(printed("rules", "base.csv", "filter.csv", "--json"))
    keeps(printed("check", str(folders / "run" / "scene.toml"), "--json"))
    keeps(printed("init", "--json"))
    (tmp_path / "filter.toml").write_text('[filter]\ncu = 1.2\ndensity = "dense"\n[packing]\ngrains = 100\n')
    words = [program, "pack", "filter.toml", "--out", "p", "--quiet"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for _, record in records(tmp_path / "p"):
        keeps(record)
    assert printed("init", "--schema", "outcome") == vw.schema("outcome")
    wrong = subprocess.run([program, "init", "--schema", "outcom"], capture_output=True, text=True)
    assert wrong.returncode == 2 and "one of outcome, manifest" in wrong.stderr


def test_a_field_that_is_gone_is_an_error(folders: Path) -> None:
    record = json.loads((folders / "run" / "outcome.json").read_text(encoding="utf-8"))
    required = vw.schema("outcome")["required"]
    assert isinstance(required, list) and {"format", "voidwalk", "model", "summary"} <= set(required)
    for field in required:
        less = copy.deepcopy(record)
        del less[field]
        assert not validator("outcome").is_valid(less), field
    deep = copy.deepcopy(record)
    del deep["summary"][0]["eroded_mass_fraction"]["mean"]
    assert not validator("outcome").is_valid(deep)


def test_a_walk_on_a_network_keeps_to_its_own() -> None:
    outcome = vw.walk(vw.Network.cubic([6, 6, 9]), 0.2, n_base=1000, replicates=2).outcome
    validator("network-walk").validate(outcome)


def test_an_unknown_form_is_refused() -> None:
    with pytest.raises(ValueError, match="name = outcom is not allowed; one of outcome, manifest"):
        vw.schema("outcom")
