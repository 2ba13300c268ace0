"""The simulator: a tower, the core inside it and a ground motion."""
from __future__ import annotations

import ctypes
import difflib
import os
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _library as library
from ._library import Array, Path, assignments, call, lib, pointer, word_list


class Copied:
    """Values that are copied without the scene behind them."""

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_scene": None}


class Result(Copied):
    """Named numbers, arrays and texts of the library, as attributes: r.j1_m, r.peak_drift_m, r.outcome.

    Units stand at the ends of the names. One number is a float, a column an array (n,), a table (rows, columns).

    Attributes
    ----------
    names : list of str
        All names.
    """

    def __init__(self, handle: Any, scene: Scene | None = None, question: Any = None) -> None:
        self.names: list[str] = []
        self._scene, self._question = scene, question
        numbers, rows, columns = library.doubles(), library.size(), library.size()
        try:
            while (name := lib.imtet_result_name(handle, len(self.names))) is not None:
                text = lib.imtet_result_text(handle, name)
                self.names.append(name.decode())
                if text is not None:
                    setattr(self, self.names[-1], text.decode(errors="replace"))
                    continue
                call("imtet_result_numbers", handle, name, ctypes.byref(numbers), ctypes.byref(rows),
                     ctypes.byref(columns))
                n, m = rows.value, columns.value
                array = np.ctypeslib.as_array(numbers, (n, m)).copy() if n * m > 0 else np.empty((n, m))
                setattr(self, self.names[-1], array if m > 1 else float(array[0, 0]) if n == 1 else array[:, 0])
        finally:
            lib.imtet_result_free(ctypes.byref(handle))

    def __getattr__(self, name: str) -> Any:
        names = self.__dict__.get("names", [])
        near = [n for n in names if n.startswith(name)] or difflib.get_close_matches(name, names, 1)
        raise AttributeError(f"no result is called {name}; " + (f"did you mean {near[0]}? " if near else "")
                             + f"there are {', '.join(names)}")

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)

    def __repr__(self) -> str:
        known = [(n, self[n]) for n in self.names]
        return f"Result({', '.join(f'{n}={v:.6g}' for n, v in known if isinstance(v, float) and v == v)})"

    def history(self, every: float | None = 0.0) -> Result:
        """Simulate the design again and give its response over time.

        Parameters
        ----------
        every : float, optional
            Largest step between rows [s]; None or 0: the step of the motion.

        Returns
        -------
        Result
            t_s (n,), floor_m, accel_g, core_m, contact_n (n, floors), and energies.
        """
        if self._scene is None:
            raise ValueError("this result is not a response, or it is a copy, which has no scene")
        if every and not (isinstance(every, (int, float, np.number)) and 1e-5 <= every <= 1e6):
            raise ValueError(f"every is {every!r}, wanted seconds from 1e-5 to 1e6, or 0 for the step of the motion")
        kind, x = self._question
        return self._scene._ask("imtet_scene_history", kind, pointer(x), 0 if x is None else x.size,
                                ctypes.c_double(every or 0))


class Scene(library.Handle):
    """A tower, the core inside it and a ground motion.

        Scene("configs/kobe.ini", record="builtin:kobe-like", **{"sim.forces": "yes"})

    Threads may simulate on one scene at once.

    Parameters
    ----------
    path : path, optional
        A settings file; None: the defaults.
    settings : iterable of str
        "section.key=value" each.
    **changes
        Settings by name. Names without a section belong to [motion]: record, unit, pga_g, stretch ... `imtet settings`
        lists all.

    Attributes
    ----------
    variables, objectives, senses : list of str
        What a design x is, and what a search for it minimises or maximises.
    lower, upper : numpy.ndarray
        (variables,) box of a search.
    floors : int
    building_hz : numpy.ndarray
        (floors,) natural frequencies of the building.
    """

    _instead = "open another imtet.Scene of the same settings; threads may share one"

    def __init__(self, path: Path | None = None, settings: Iterable[str] = (), **changes: Any) -> None:
        self._scene = library.handle()
        changes = {k: os.path.abspath(v) if k in ("record", "motion.record") and os.path.exists(v) else v
                   for k, v in changes.items()}
        call("imtet_scene_open", None if path is None else os.fsencode(path),
             word_list([*settings, *assignments("motion", changes)]), ctypes.byref(self._scene))
        about = self._ask("imtet_scene_describe")
        self.variables: list[str] = about.variables.split(",")
        self.objectives: list[str] = about.objectives.split(",")
        self.senses: list[str] = about.senses.split(",")
        self.floors, self.record = int(about.floors), str(about.record)
        self.lower: Array = np.atleast_1d(about.lower)
        self.upper: Array = np.atleast_1d(about.upper)
        self.building_hz: Array = np.atleast_1d(about.building_hz)

    def __repr__(self) -> str:
        return f"<imtet.Scene: {self.floors} floors, {len(self.variables)} variables, {self.record}>"

    def __del__(self) -> None:
        if getattr(self, "_scene", None):
            lib.imtet_scene_free(ctypes.byref(self._scene))

    def _ask(self, function: str, *arguments: Any, question: Any = None) -> Result:
        handle = library.handle()
        call(function, self._scene, *arguments, ctypes.byref(handle))
        return Result(handle, self if question else None, question)

    def design(self, gaps: npt.ArrayLike | None = None, thickness: npt.ArrayLike | None = None, **others: float) -> Array:
        """Make a design x from names.

        Parameters
        ----------
        gaps : float or array_like
            [m] One for all floors, or one per floor.
        thickness : float or array_like
            [m] One, or one at the foot and one at the top.
        **others
            Further variables: side_m=9.

        Returns
        -------
        numpy.ndarray
            (variables,).
        """
        given = {name: library.row(name, value, 1).item() for name, value in others.items()}
        for what, wanted, start in (("gaps", gaps, "gap_"), ("thickness", thickness, "t_")):
            names = [n for n in self.variables if n.startswith(start)] or [what]
            if wanted is not None:
                values = library.numbers(what, wanted, f"() or ({len(names)},)")
                if values.shape not in ((), (1,), (len(names),)):
                    raise ValueError(f"{what} has shape {values.shape}, wanted one number or ({len(names)},)")
                given.update(zip(names, np.broadcast_to(values, len(names))))
        missing = [n for n in self.variables if n not in given]
        unknown = [n for n in given if n not in self.variables]
        if unknown:
            near = difflib.get_close_matches(unknown[0], ["gaps", "thickness", *self.variables], 1)
            raise ValueError(f"no variable of this scene: {', '.join(unknown)}" + (f"; did you mean {near[0]}?" if near else "")
                             + f"; it has {', '.join(self.variables)}")
        if missing:
            raise ValueError(f"missing: {', '.join(missing)}")
        return np.array([given[n] for n in self.variables])

    def simulate(self, x: npt.ArrayLike | None = None, *, gaps: npt.ArrayLike | None = None,
                 thickness: npt.ArrayLike | None = None, kind: str = "with_core", **others: float) -> Result:
        """Simulate a design.

        Parameters
        ----------
        x : array_like
            (variables,). Instead `gaps`, `thickness` and others, as for `design`.
        kind : {"with_core", "no_core", "rigid", "tmd", "links"}
            The design, or a baseline: the building alone; floors and core rigidly connected; with a tuned mass damper; with
            viscous links. The devices of the last two are the best ones.

        Returns
        -------
        Result
            j1_m, j2_m, j3_g, ...; per floor peak_displacement_m, peak_drift_m, peak_acceleration_g. Do not use the numbers
            if `outcome` is not "ok".
        """
        named = {k: v for k, v in {"gaps": gaps, "thickness": thickness, **others}.items() if v is not None}
        if x is not None and named:
            raise TypeError(f"x and {', '.join(named)} are given: give x alone, or no x; scene.design({next(iter(named))}=...) "
                            "makes an x")
        if named or (x is None and kind != "no_core"):
            x = self.design(gaps, thickness, **others)
        row = None if x is None else library.row("x", x, len(self.variables))
        word = library.one_text(kind)
        return self._ask("imtet_scene_simulate", word, pointer(row), 0 if row is None else row.size, question=(word, row))

    def evaluate(self, x: npt.ArrayLike) -> list[float]:
        """The objectives of the scene, for `Search.evaluate`; ArithmeticError if the simulation fails."""
        r = self.simulate(x)
        if r.outcome != "ok":
            raise ArithmeticError(r.reason)
        return [r[name] for name in self.objectives]


def read_motion(path: Path, **settings: object) -> tuple[float, Array, dict[str, str]]:
    """Read a ground motion in any format that the program knows.

    Parameters
    ----------
    path : path
        A record, or builtin:NAME.
    **settings
        Settings of [motion]: unit="g", channel=2, pga_g=0.3. Without them the motion is as recorded.

    Returns
    -------
    dt : float
        [s]
    acceleration : numpy.ndarray
        (n,) [m/s2]
    about : dict
        name, format, channel, processed, warning.
    """
    handle = library.handle()
    call("imtet_motion_read", os.fsencode(path), word_list(assignments("motion", settings)), ctypes.byref(handle))
    r = Result(handle)
    about = {name: r[name] for name in r.names if isinstance(r[name], str)}
    return r.dt_s, np.atleast_1d(r.acceleration), about
