"""libimtet.so by ctypes: where it is found, its structures, its errors as exceptions, and the shapes of arrays."""
from __future__ import annotations

import ctypes
import ctypes.util
import os
import re
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]
Catch = Union[type[BaseException], tuple[type[BaseException], ...]]


class ImtetError(Exception):
    """An error of the library, a sentence that says what to do.

    Attributes
    ----------
    status : int
        MISUSED 1, BAD_DATA 2, MISSING 3, INTERNAL 5, NO_MEMORY 6, IO 7 (imtet.h).
    """

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class Error(ctypes.Structure):
    _fields_ = [("status", ctypes.c_int), ("text", ctypes.c_char * 480)]


doubles = ctypes.POINTER(ctypes.c_double)
Words = ctypes.POINTER(ctypes.c_char_p)
size, handle = ctypes.c_size_t, ctypes.c_void_p


class Options(ctypes.Structure):
    _fields_ = [("size", size), ("variables", size), ("objectives", size), ("constraints", size), ("lower", doubles),
                ("upper", doubles), ("kinds", ctypes.c_char_p), ("senses", ctypes.c_char_p), ("starts", size),
                ("start", doubles), ("settings", Words)]


class State(ctypes.Structure):
    _fields_ = [*((name, size) for name in ("size", "variables", "objectives", "constraints", "told", "failed",
                                            "under_way", "ready", "left")),
                ("done", ctypes.c_int), ("why", ctypes.c_char_p), ("senses", ctypes.c_char_p), ("lower", doubles),
                ("upper", doubles)]


def _load() -> ctypes.CDLL:
    """IMTET_LIBRARY, what a wheel has beside this file, what was built in this tree, or what is installed."""
    here = os.path.dirname(os.path.abspath(__file__))
    wanted = os.environ.get("IMTET_LIBRARY")
    names: list[str | None] = [wanted] if wanted else [os.path.join(here, "libimtet.so"),
                                     os.path.join(here, "..", "..", "build", "release", "libimtet.so"),
                                     "libimtet.so.0", "/usr/local/lib/libimtet.so.0", ctypes.util.find_library("imtet")]
    faults = []
    for name in filter(None, names):
        if wanted or os.path.sep not in name or os.path.exists(name):
            try:
                return ctypes.CDLL(name)
            except OSError as fault:
                faults.append(str(fault))
    raise ImportError("libimtet.so was not found (make && sudo make install, or set IMTET_LIBRARY to its path): "
                      + "; ".join(faults))


lib = _load()
lib.imtet_version.restype = ctypes.c_char_p
lib.imtet_result_name.restype = lib.imtet_result_text.restype = ctypes.c_char_p
lib.imtet_result_name.argtypes = [handle, size]
lib.imtet_result_text.argtypes = [handle, ctypes.c_char_p]
lib.imtet_search_free.restype = lib.imtet_scene_free.restype = lib.imtet_result_free.restype = None

__version__: str = lib.imtet_version().decode()

# Settings whose argument of Search has another name.
ARGUMENTS = {"max_evals": "evaluations", "variables": "lower and upper"}


def call(name: str, *arguments: Any) -> None:
    """Call a function of the library. Errors of a search name arguments, not settings; notes become warnings."""
    error = Error()
    failed = getattr(lib, name)(*arguments, ctypes.byref(error))
    text = error.text.decode(errors="replace")
    if name.startswith("imtet_search"):
        text = re.sub(r"\b(?:search|problem)\.(\w+)", lambda key: ARGUMENTS.get(key[1], key[1]), text)
    if failed:
        raise ImtetError(error.status, text)
    if text:
        warnings.warn(text, RuntimeWarning, stacklevel=3)


def pointer(array: Array | None) -> Any:
    return None if array is None else array.ctypes.data_as(doubles)


def word_list(words: Iterable[str]) -> Any:
    encoded = [os.fsencode(w) for w in words]
    return (ctypes.c_char_p * (len(encoded) + 1))(*encoded, None)


def one_text(words: str | Sequence[str] | None) -> bytes | None:
    """One word for all, or a list of them."""
    return None if words is None else (words if isinstance(words, str) else ",".join(words)).encode()


def assignments(section: str, settings: Mapping[str, object]) -> list[str]:
    """{"population": 40, "sim.forces": "yes"} as "section.key=value"."""
    words = {True: "on", False: "off"}
    return [f"{key if '.' in key else section + '.' + key}={words[value] if isinstance(value, bool) else value}"
            for key, value in settings.items()]


def numbers(what: str, values: object, wanted: str) -> Array:
    """An array of float64, or ValueError with the shape that is wanted."""
    try:
        return np.asarray(values, dtype=np.float64, order="C")
    except (TypeError, ValueError) as fault:
        raise ValueError(f"{what}: {fault}; wanted numbers of shape {wanted}") from None


def matrix(what: str, values: object, columns: int) -> Array:
    """(n, columns); one row of them may be a plain list."""
    array = numbers(what, values, f"(n, {columns})")
    if array.ndim == 1 and array.size == columns:
        array = array.reshape(1, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{what} has shape {array.shape}, wanted (n, {columns})")
    return array


def row(what: str, values: object, n: int) -> Array:
    """(n,); a number will do if n is 1."""
    array = numbers(what, values, f"({n},)")
    if array.shape != (n,) and not (n == 1 and array.ndim == 0):
        raise ValueError(f"{what} has shape {array.shape}, wanted ({n},)")
    return array


def rows(what: str, values: Any, n: int, columns: int) -> list[Any]:
    """A list of n rows, whatever each of them is."""
    try:
        found = list(getattr(values, "to_numpy", lambda: values)())
    except TypeError:
        raise ValueError(f"{what} is {values!r}, wanted rows of shape ({n}, {columns})") from None
    if len(found) != n:
        raise ValueError(f"X has {n} rows, {what} {len(found)}: wanted shape ({n}, {columns})")
    return found


class Handle:
    """An object of the library has one owner here: a copy would free it twice."""

    _instead = ""

    def __reduce_ex__(self, protocol: object) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled: {self._instead}")
