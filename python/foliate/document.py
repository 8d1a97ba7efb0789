"""Dictionaries as scene files have them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

__all__ = ["json_of", "plain"]


def plain(value: Any, where: str = "the scene") -> Any:
    """The same of dictionaries, lists, strings, truth values and numbers. What is ``None`` in a dictionary is left out.

    Raises ``ValueError`` where something has no form in a scene file.
    """
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise ValueError(f"{where}: the key {key!r} is no string")
        return {key: plain(item, f"{where}, `{key}`") for key, item in value.items() if item is not None}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist(), where)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Sequence | set | frozenset):
        return [plain(item, where) for item in value]
    raise ValueError(f"{where}: {value!r} has no form in a scene file")


def json_of(document: Mapping[str, Any]) -> str:
    """The document as JSON. Raises ``ValueError`` where a number is not finite, or something has no form in a scene file."""
    return json.dumps(plain(document), allow_nan=False)
