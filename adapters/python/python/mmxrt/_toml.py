"""Values of Python as TOML, which is what scenes are checked as."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def plain(value: Any) -> Any:
    """A value without NumPy's types, paths and tuples: what TOML can hold. A copy.

    Raises `TypeError` for anything else.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items() if inner is not None}
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return [plain(inner) for inner in value]
    raise TypeError(f"a scene holds numbers, texts, lists and dictionaries, not {type(value).__name__}")


def key(name: str) -> str:
    """A key as it is written."""
    return name if _BARE.fullmatch(name) else text(name)


def text(value: str) -> str:
    """A text in quotes."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")


def unquoted(quoted: str) -> str:
    """The text that `text` has put in quotes.

    Raises `ValueError` for other escapes.
    """
    return str(json.loads(quoted))


def value(given: Any) -> str:
    """A plain value on one line."""
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, str):
        return text(given)
    if isinstance(given, dict):
        return "{ " + ", ".join(f"{key(name)} = {value(inner)}" for name, inner in given.items()) + " }"
    if isinstance(given, list):
        return "[" + ", ".join(value(inner) for inner in given) + "]"
    # Infinity and NaN are the same words in TOML; no scene can hold them, and its reader says where.
    return repr(given)


def document(tree: dict[str, Any]) -> str:
    """A dictionary as a text, with a line for each item of its tables, so that messages point at it."""
    plain_items = {name: inner for name, inner in tree.items() if not isinstance(inner, dict)}
    lines = [f"{key(name)} = {value(inner)}" for name, inner in plain_items.items()]
    for name, table in tree.items():
        if isinstance(table, dict):
            lines.append(f"[{key(name)}]")
            lines.extend(f"{key(inner)} = {value(item)}" for inner, item in table.items())
    return "\n".join(lines) + "\n"
