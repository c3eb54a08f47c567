"""Values as TOML. No `bpy`."""

import math
import re


def key(name):
    """A key, quoted where it needs it."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else string(name)


def string(text):
    """A basic string."""
    special = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    return '"' + "".join(special.get(c) or (f"\\u{ord(c):04x}" if ord(c) < 32 or ord(c) == 127 else c) for c in text) + '"'


def value(of):
    """A number, text, truth value, list or table, inline; numbers keep all their digits."""
    if isinstance(of, bool):
        return "true" if of else "false"
    if isinstance(of, int):
        return str(of)
    if isinstance(of, float):
        if not math.isfinite(of):
            raise ValueError(f"{of} is not a number that a scene can hold")
        return repr(of)
    if isinstance(of, str):
        return string(of)
    if isinstance(of, dict):
        return "{ " + ", ".join(f"{key(k)} = {value(v)}" for k, v in of.items()) + " }" if of else "{}"
    return "[" + ", ".join(value(v) for v in of) + "]"


class Raw(str):
    """Text that is TOML already, such as a table that was typed in."""


def table(name, keys, is_array=False):
    """A table with its heading; `None` leaves a key out. Empty lines are left to the caller."""
    heading = f"[[{name}]]" if is_array else f"[{name}]"
    lines = [f"{key(k)} = {v if isinstance(v, Raw) else value(v)}" for k, v in keys.items() if v is not None]
    return "\n".join([heading] + lines) + "\n"
