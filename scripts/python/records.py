#!/usr/bin/env python3
"""Writes records.py, columns.py and settings.py into scripts/python/python/voidwalk: the types of every JSON record, of the columns of
tables and of a scene's settings, from what the program prints. The program is that of this checkout, or what VOIDWALK_PROGRAM names."""

from __future__ import annotations

import json
import keyword
import os
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any, Dict, Iterable, List, Tuple

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = Path(__file__).resolve().parent / "python" / "voidwalk"

#: What a user meets, the most important first; each gives the name of its type.
ROOTS = {
    "outcome": "Outcome",
    "network-walk": "WalkOutcome",
    "specification": "Specification",
    "boundary": "Boundaries",
    "percolation": "PercolationStudy",
    "rules": "PairRules",
    "soils": "Soils",
    "constrictions": "ConstrictionsSummary",
    "packing": "PackingRecord",
    "manifest": "Manifest",
}

#: The longest list of words that is written where it is used; a longer one has a name.
LONGEST = 500

HEAD = '''"""The types of what voidwalk hands out as dicts: the records of its JSON files.

Made by ``scripts/python/records.py`` from the JSON Schemas, which ``voidwalk init --schema NAME`` prints.
"""

from __future__ import annotations

from typing import Dict, List, Literal, Optional, TypedDict, Union

'''


class Types:
    """The types that were met, each once, those that others need first."""

    def __init__(self) -> None:
        self.texts: Dict[str, str] = {}

    def of(self, schema: Any, defs: Dict[str, Any]) -> str:
        """The annotation of a schema."""
        if schema is True:
            return "object"
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            return self.named(name, defs[name], defs)
        for several in ("anyOf", "oneOf"):
            if several in schema:
                return self.union([self.of(one, defs) for one in schema[several]])
        if "const" in schema:
            return f"Literal[{json.dumps(schema['const'])}]"
        if "enum" in schema:
            return f"Literal[{', '.join(json.dumps(word) for word in schema['enum'])}]"
        # A value of any kind, which a description alone makes no other.
        if "type" not in schema:
            return "object"
        kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        return self.union([self.kind(kind, schema, defs) for kind in kinds])

    @staticmethod
    def union(kinds: List[str]) -> str:
        """Literals together, and what may be missing as such."""
        words = [kind[len("Literal[") : -1] for kind in kinds if kind.startswith("Literal[")]
        others = [kind for kind in dict.fromkeys(kinds) if not kind.startswith("Literal[") and kind != "None"]
        if words:
            others.insert(0, f"Literal[{', '.join(words)}]")
        if not others:
            return "None"
        text = others[0] if len(others) == 1 else f"Union[{', '.join(others)}]"
        return f"Optional[{text}]" if "None" in kinds else text

    def kind(self, kind: str, schema: Any, defs: Dict[str, Any]) -> str:
        """The annotation of one kind of value."""
        plain = {"string": "str", "boolean": "bool", "integer": "int", "number": "float", "null": "None"}
        if kind in plain:
            return plain[kind]
        if kind == "array":
            return f"List[{self.of(schema.get('items', True), defs)}]"
        if "properties" in schema:
            fields = {name: self.of(of, defs) for name, of in schema["properties"].items()}
            return f"Dict[str, {self.union(list(fields.values()))}]"
        return f"Dict[str, {self.of(schema.get('additionalProperties', True), defs)}]"

    def named(self, name: str, schema: Any, defs: Dict[str, Any]) -> str:
        """A type that has a name: a dict with its fields, or what stands for it."""
        if all("properties" in one for one in schema.get("oneOf", [{}])):
            schema = merged(schema)
        if "properties" not in schema or schema.get("type") != "object":
            kind = self.of(schema, defs)
            if not kind.startswith("Literal[") or len(kind) <= LONGEST:
                return kind
            listed = json.loads(f"[{kind[len('Literal[') : -1]}]")
            words = "".join(f"    {json.dumps(word)},\n" for word in listed)
            self.texts.setdefault(name, f"{comment(schema)}{name} = Literal[\n{words}]\n")
            return name
        required = set(schema.get("required", []))
        groups: Tuple[List[str], List[str]] = ([], [])
        # A class cannot have a field that is called as a word of the language is: a call can.
        if any(keyword.iskeyword(field) and field not in required for field in schema["properties"]):
            sys.exit(f"{name} has a field that may be missing, and is a word of Python")
        if any(keyword.iskeyword(field) for field in required) and required == set(schema["properties"]):
            self.texts.setdefault(name, comment(schema) + self.spelled(name, schema, defs))
            return name
        for field, of in schema["properties"].items():
            groups[field not in required].append(f"    {field}: {self.of(of, defs)}\n")
        text, bases, fields = "", "TypedDict, total=False" if groups[1] else "TypedDict", groups[1] or groups[0]
        if groups[1] and groups[0]:
            text = f"class _{name}(TypedDict):\n{''.join(groups[0])}\n\n"
            if any(keyword.iskeyword(field) for field in required):
                text = f"{self.spelled(f'_{name}', schema, defs)}\n\n"
            bases = f"_{name}, total=False"
        text += class_text(name, bases, schema.get("description", ""), schema["properties"], fields)
        if self.texts.setdefault(name, text) != text:
            sys.exit(f"{name} is two types")
        return name

    def spelled(self, name: str, schema: Any, defs: Dict[str, Any]) -> str:
        """The type of the fields that are always there, as a call."""
        required = set(schema.get("required", []))
        kinds = {field: self.of(of, defs) for field, of in schema["properties"].items() if field in required}
        fields = "".join(f'        "{field}": {kind},\n' for field, kind in kinds.items())
        return f'{name} = TypedDict(\n    "{name}",\n    {{\n{fields}    }},\n)\n'


def merged(schema: Any) -> Any:
    """One dict in place of several, which are told apart by a word: with the fields of all."""
    fields: Dict[str, List[Any]] = {}
    # What a field without a description is: of a word that tells them apart each word, of another field its first case.
    told: Dict[str, List[str]] = {}
    for one in schema["oneOf"]:
        about = one.get("description", "")
        for field, of in one["properties"].items():
            if "const" in of:
                told.setdefault(field, []).append(f"`{of['const']}`: {about}" if about else f"`{of['const']}`.")
            else:
                told.setdefault(field, [about])
            if of not in fields.setdefault(field, []):
                fields[field].append(of)
    always = [set(one.get("required", [])) for one in schema["oneOf"]]
    return {
        "type": "object",
        "description": schema.get("description", ""),
        "properties": {
            field: {
                **(of[0] if len(of) == 1 else {"anyOf": of}),
                "description": of[0].get("description") or " ".join(told[field]),
            }
            for field, of in fields.items()
        },
        "required": [field for field in fields if all(field in one for one in always)],
    }


def plain(said: str) -> str:
    """A description without the marks of Rust's documentation, in one line."""
    return " ".join(said.replace("[`", "`").replace("`]", "`").split())


def class_text(name: str, bases: str, said: str, about: Dict[str, Any], fields: List[str]) -> str:
    """A type as a class, whose docstring says what each of its fields is: help() shows no comments."""
    doc = "\n    ".join(textwrap.wrap(plain(said).replace("\\", "\\\\"), 110)) or "A record."
    lines = [f'    """{doc}\n\n    Keys\n    ----\n']
    for field, of in about.items():
        words = of.get("description", "") if isinstance(of, dict) else ""
        lines.append(f"    {field}\n")
        lines += [f"        {line}\n" for line in textwrap.wrap(plain(words).replace("\\", "\\\\"), 104)]
    return f"class {name}({bases}):\n{''.join(lines)}    \"\"\"\n\n{''.join(fields)}"


def comment(schema: Any) -> str:
    """The description of a type as comments above it."""
    return "".join(f"#: {line}\n" for line in textwrap.wrap(plain(schema.get("description", "")), 106))


def module(head: str, names: Iterable[str], texts: Iterable[str]) -> str:
    """A module of types."""
    listed = "".join(f'    "{name}",\n' for name in sorted(names))
    return f"{head}__all__ = [\n{listed}]\n\n\n" + "\n\n".join(texts)


def printed(*words: str) -> Any:
    """What `voidwalk init` prints."""
    named = os.environ.get("VOIDWALK_PROGRAM")
    program = [named] if named else ["cargo", "run", "--locked", "--quiet", "--bin", "voidwalk", "--"]
    return json.loads(subprocess.check_output([*program, "init", *words], cwd=ROOT))


def records_text() -> str:
    """The module of the records."""
    types = Types()
    for name, called in ROOTS.items():
        schema = printed("--schema", name)
        types.named(called, schema, schema.get("$defs", {}))
    return module(HEAD, types.texts, types.texts.values())


COLUMNS_HEAD = '''"""The types of tables: the columns of the CSV files of a run, of boundaries and of a campaign.

Made by ``scripts/python/records.py`` from what ``voidwalk init --schema columns`` prints. A number that a file leaves
empty is NaN here.
"""

from __future__ import annotations

from typing import Dict, TypedDict, Union

import numpy as np
from numpy.typing import NDArray

#: Numbers with a point.
Floats = NDArray[np.float64]
#: Counts.
Counts = NDArray[np.uint64]
#: Whole numbers, of which -1 stands for what has no number.
Whole = NDArray[np.int64]
#: Words.
Words = NDArray[np.str_]

#: A column of a table whose columns depend on what was asked for.
Column = Union[Floats, Counts, Whole, Words]

#: Such a table: its columns by their names.
Table = Dict[str, Column]

'''

#: What the columns of rows are called, by the rows of a file.
TABLES = {
    "SeriesRow": "Series",
    "LayerRow": "Layers",
    "SizeRow": "Sizes",
    "FlowRow": "Flow",
    "RetainedRow": "RetainedByVoid",
    "BlockedRow": "Blockings",
    "WalkRow": "Walked",
}


def columns_text() -> str:
    """The module of the columns of tables."""
    rows = printed("--schema", "columns")["$defs"]
    kinds = {"uint64": "Counts", "int64": "Whole", "double": "Floats"}
    classes = []
    for row, name in TABLES.items():
        about = rows[row]["properties"]
        columns = [f"    {field}: {kinds.get(of.get('format'), 'Words')}\n" for field, of in about.items()]
        classes.append(class_text(name, "TypedDict", rows[row]["description"], about, columns))
    return module(COLUMNS_HEAD, ["Column", "Table", *TABLES.values()], classes)


SETTINGS_HEAD = '''"""The types of a scene's settings, as :attr:`voidwalk.Scene.settings` gives them: lengths in mm, as numbers.

Made by ``scripts/python/records.py`` from what ``voidwalk init --json`` prints. A setting that a scene
does not have is not there.
"""

from __future__ import annotations

from typing import Dict, List, TypedDict, Union

'''

#: The kinds of settings, as they are read back.
KINDS = {
    "integer": "int",
    "float": "float",
    "float or string": "float",
    "string": "str",
    "string or table": "Union[str, Dict[str, object]]",
    "boolean": "bool",
    "array of integers": "List[int]",
    "array of floats": "List[float]",
}


def settings_text(told: Any) -> str:
    """The module of the settings."""
    classes = {}
    sections = sorted(told["sections"], key=lambda section: section["name"] == "")
    for section in sections:
        name = f"{section['name'].capitalize() or 'Scene'}Settings"
        of_section = {of["name"].rsplit(".", 1)[-1]: of for of in section["settings"]}
        fields = [f"    {field}: {KINDS[of['type']]}\n" for field, of in of_section.items()]
        about = {field: {"description": of["meaning"]} for field, of in of_section.items()}
        if not section["name"]:
            others = [other["name"] for other in sections if other["name"]]
            fields += [f"    {other}: {other.capitalize()}Settings\n" for other in others]
            about |= {other: {"description": f"Its section [{other}]."} for other in others}
        classes[name] = class_text(name, "TypedDict, total=False", section["about"], about, fields)
    return module(SETTINGS_HEAD, classes, classes.values())


def write() -> None:
    """Writes the modules."""
    (PACKAGE / "columns.py").write_text(columns_text(), encoding="utf-8")
    (PACKAGE / "records.py").write_text(records_text(), encoding="utf-8")
    (PACKAGE / "settings.py").write_text(settings_text(printed("--json")), encoding="utf-8")


if __name__ == "__main__":
    write()
