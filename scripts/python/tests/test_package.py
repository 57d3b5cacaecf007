"""The package itself: version, types, the names that are a contract."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import voidwalk as vw
from voidwalk import settings
from voidwalk.settings import SceneSettings


def held_by_mypy(folder: Path, *words: str) -> None:
    """Mypy has nothing to say."""
    pytest.importorskip("mypy")
    said = subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True, cwd=folder)
    assert said.returncode == 0, said.stdout + said.stderr


def test_the_version_is_that_of_the_crate() -> None:
    manifests = [ROOT / "Cargo.toml", ROOT / "scripts" / "python" / "Cargo.toml"]
    for manifest in manifests:
        found = re.search(r'^version = "(.*)"', manifest.read_text(), re.MULTILINE)
        assert found is not None and found[1] == vw.__version__, manifest


def test_the_names_that_others_call_are_there() -> None:
    assert list(inspect.signature(vw.run).parameters)[:3] == ["scene", "out", "threads"]
    assert list(inspect.signature(vw.Network).parameters)[:4] == ["conns", "diameter", "inlets", "outlets"]
    assert list(inspect.signature(vw.constrictions).parameters)[:3] == ["coords", "diameter", "cell"]
    assert list(inspect.signature(vw.walk).parameters)[:2] == ["network", "base"]


def test_every_name_says_what_it_is() -> None:
    for name in vw.__all__:
        thing = getattr(vw, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and thing.__module__.startswith("voidwalk."):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, (classmethod, property))):
                    assert inspect.getdoc(value), f"{name}.{member}"
                if not member.startswith("_") and inspect.ismemberdescriptor(value):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_the_stubs_are_those_of_the_binary(tmp_path: Path) -> None:
    held_by_mypy(tmp_path, "mypy.stubtest", "voidwalk._voidwalk", "--mypy-config-file", "/dev/null")


def test_the_package_is_typed_strictly(tmp_path: Path) -> None:
    assert (Path(vw.__file__).parent / "py.typed").exists()
    held_by_mypy(tmp_path, "mypy", "--strict", "-p", "voidwalk")


def test_nothing_that_a_user_touches_is_of_any_type() -> None:
    """Parameters, results and attributes of what is public; and the types of records, tables and settings."""
    package = Path(vw.__file__).parent
    for path in sorted([*package.glob("*.py"), *package.glob("*.pyi")]):
        assert re.search(r"\bAny\b", path.read_text(encoding="utf-8")) is None, path.name


def test_the_settings_of_a_scene_are_those_of_the_program() -> None:
    sys.path.insert(0, str(ROOT / "scripts" / "python"))
    import records

    words = [sys.executable, "-m", "voidwalk", "init", "--json"]
    told = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
    assert Path(str(settings.__file__)).read_text(encoding="utf-8") == records.settings_text(told)
    typed = SceneSettings.__annotations__
    scene = vw.Scene(settings={"base.regrade": "no", "stop.decide_percent": 99.0, "walk.exit": "area"})
    for name, value in scene.settings.items():
        assert name in typed, name
        if isinstance(value, dict):
            of_section = getattr(settings, f"{name.capitalize()}Settings").__annotations__
            assert set(value) <= set(of_section), name


def test_the_examples_are_typed_strictly(tmp_path: Path) -> None:
    page = (ROOT / "src" / "docs" / "python.md").read_text(encoding="utf-8")
    guide = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert len(guide) > 2
    (tmp_path / "guide.py").write_text("".join(guide), encoding="utf-8")
    examples = [tmp_path / "guide.py", *sorted((ROOT / "scripts" / "examples").glob("*.py"))]
    held_by_mypy(tmp_path, "mypy", "--strict", *map(str, examples))


def test_what_the_readme_shows_runs_without_a_warning() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    done = subprocess.run([sys.executable, "-W", "error", "-c", block], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("continuing erosion 0.")
