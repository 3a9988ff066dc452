"""Scenes as TOML, from dictionaries: what tomllib reads, written."""
from numbers import Integral, Real
from typing import Any, Mapping

from .problem import SceneError


def scalar(value: Any, key: str) -> str:
    """A value as TOML has it: numbers of numpy, too."""
    if type(value).__name__ in ("bool", "bool_"):   # the latter of numpy, which need not be there
        return "true" if value else "false"
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return repr(float(value))
    if isinstance(value, str):
        escaped = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
        return '"' + "".join(escaped.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in value) + '"'
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{name(k, key)} = {scalar(v, f'{key}.{k}')}" for k, v in value.items()) + " }"
    try:
        return "[" + ", ".join(scalar(entry, key) for entry in value) + "]"   # lists, tuples, arrays
    except TypeError:
        error = SceneError(f"{key}: is a {type(value).__name__}; give a number, a text, a list or a dictionary")
        error.code, error.key = 2, key
        raise error from None


def name(key: Any, table: str) -> str:
    """A name of a key, quoted where it must be."""
    if not isinstance(key, str):
        raise SceneError(f"{table}: {key!r} is no name of a key; give texts")
    plain = key and all(c.isascii() and (c.isalnum() or c in "_-") for c in key)
    return key if plain else scalar(key, table)


def dumps(scene: Mapping[str, Any]) -> str:
    """A scene as text: keys above all tables first, then a table for each dictionary, one key a line."""
    lines = [f"{name(key, '')} = {scalar(value, key)}" for key, value in scene.items() if not isinstance(value, Mapping)]
    for table, keys in scene.items():
        if isinstance(keys, Mapping):
            lines += ["", f"[{name(table, '')}]"]
            lines += [f"{name(key, table)} = {scalar(value, f'{table}.{key}')}" for key, value in keys.items()]
    return "\n".join(lines) + "\n"
