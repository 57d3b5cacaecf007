"""Scenes: one base-filter combination and how it is to be walked; and the schemas of what is written of it."""

from __future__ import annotations

import json
import os
from typing import Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _voidwalk
from .settings import SceneSettings

__all__ = ["Scene", "init_text", "scene_text", "schema"]

#: What a setting may be: a number, a word, a path, a list of them, or a table.
Setting = Union[None, bool, float, str, "os.PathLike[str]", Sequence[object], Mapping[str, object]]

#: Settings by their names, as ``{"base.cu": 3}``, or tables of them by section; each value is a :data:`Setting`.
Settings = Mapping[str, object]

#: A scene's file, what it would say, or nothing for the built-in scene.
Stated = Union[None, str, "os.PathLike[str]", Settings]


class Scene:
    """A base-filter combination and how it is to be walked: every setting checked, given or by default.

    Parameters
    ----------
    scene : Scene, path-like, mapping or None
        A scene's file, or a dict with what it would say; the built-in scene without one. Paths in a file are
        taken from its folder, those in a dict from the working directory. The files that they name are read
        when the scene is walked.
    settings : mapping, optional
        Settings that change it, as ``{"base.cu": 3}``.

    Raises
    ------
    ValueError
        What is refused, in the words of the command line.

    Notes
    -----
    A scene never changes, compares by its settings, and is pickled by them.

    Examples
    --------
    >>> import voidwalk as vw
    >>> scene = vw.Scene(settings={"base.cu": 3, "replicates": 2})
    >>> scene.settings["base"]["cu"], scene.settings["replicates"]
    (3.0, 2)
    >>> vw.Scene(scene, {"replicates": 4}).settings["replicates"]
    4
    """

    __slots__ = ("_native",)

    def __init__(self, scene: Union[Scene, Stated] = None, settings: Optional[Settings] = None) -> None:
        self._native = native_scene(scene, settings)

    @classmethod
    def from_toml(cls, text: str, name: str = "scene") -> Scene:
        """A scene from the text of its file; `name` stands for the file in errors."""
        return cls._of(_voidwalk.Scene.from_toml(text, name, []))

    @classmethod
    def _of(cls, native: _voidwalk.Scene) -> Scene:
        new = cls.__new__(cls)
        new._native = native
        return new

    @property
    def settings(self) -> SceneSettings:
        """Every setting that the scene has: a dict that changes nothing when it is changed."""
        settings: SceneSettings = json.loads(self._native.to_json())
        return settings

    def to_toml(self) -> str:
        """The scene as the text of its file: read again, it is the same scene."""
        return self._native.to_toml()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> Tuple[object, ...]:
        return type(self).from_toml, (self.to_toml(), self._native.name)

    def __repr__(self) -> str:
        said = self.settings
        parts = [f"{key} {value}" for key, value in said.items() if key in ("seed", "replicates")]
        return f"Scene({self._native.name}: {', '.join(parts)})"


def assignments(settings: Optional[Settings]) -> List[str]:
    """Settings as the library takes them: ``base.cu=3``."""
    stated = _stated(settings or {})
    return [f"{key}={json.dumps(of, default=_plain, allow_nan=False)}" for key, of in stated.items()]


def native_scene(scene: Union[Scene, Stated], settings: Optional[Settings] = None) -> _voidwalk.Scene:
    """The library's scene of what a user states, with the settings that change it."""
    changes = assignments(settings)
    if scene is None:
        return _voidwalk.Scene.built_in(changes)
    if isinstance(scene, Scene):
        native = scene._native
        return _voidwalk.Scene.from_toml(native.to_toml(), native.name, changes) if changes else native
    if isinstance(scene, Mapping):
        return _voidwalk.Scene.from_json(as_json(scene), changes)
    return _voidwalk.Scene.from_file(os.fspath(scene), changes)


def as_json(table: Settings) -> str:
    """What a scene's or plan's dict says, for the library."""
    try:
        return json.dumps(_stated(table), default=_plain, allow_nan=False)
    except TypeError as error:
        raise ValueError(f"scene: {error}") from None


def _plain(value: object) -> object:
    """Values of arrays and paths as JSON knows them."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise ValueError(f"{value!r} is not allowed in a scene; numbers, words, lists and tables are")


def _stated(settings: Mapping[str, object]) -> Dict[str, object]:
    """A dict without the settings that are ``None``: those are not given."""

    def of(value: object) -> object:
        return _stated(value) if isinstance(value, Mapping) else value

    return {str(key): of(value) for key, value in settings.items() if value is not None}


def scene_text(scene: Union[Scene, Stated] = None, settings: Optional[Settings] = None) -> str:
    """A scene with every setting that it has, as TOML; the built-in scene without one.

    Examples
    --------
    >>> import voidwalk as vw
    >>> "cu = 3" in vw.scene_text(settings={"base.cu": 3})
    True
    """
    return native_scene(scene, settings).to_toml()


def init_text() -> str:
    """The built-in scene as TOML, with every setting there is and what it means, as ``voidwalk init`` writes it."""
    return _voidwalk.init_text()


def schema(name: str) -> Dict[str, object]:
    """The JSON Schema of a file, as ``voidwalk init --schema NAME`` prints it.

    Parameters
    ----------
    name : str
        The name of its form without number, as ``"outcome"`` for ``outcome.json``.

    Examples
    --------
    >>> import voidwalk as vw
    >>> vw.schema("outcome")["title"]
    'outcome.json'
    """
    found: Dict[str, object] = json.loads(_voidwalk.schema(name))
    return found
