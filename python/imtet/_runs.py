"""Runs of `imtet optimize`, read from their database."""
from __future__ import annotations

import configparser
import functools
import json
import operator
import os
import shlex
import sqlite3
import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from ._library import Array, ImtetError, Path
from ._scene import Copied, Result, Scene
from ._tables import Tabular

Records = np.recarray[Any, np.dtype[np.void]]

_MORE_IS_BETTER, _OUTSIDE = {"ed5_10_pct", "edcs_pct", "ed_devices_pct"}, ("polished", "kept")  # measures; kinds no search sees
_ERRORS = {"coarse": 0.08, "standard": 0.01}  # as numbers, by their steps per contact
_NOT_OF_THE_PROBLEM = ("search.", "run.", "problem.command", "problem.timeout_s", "sim.threads")
_FILES = ("motion.record", "motion.records", "motion.forces", "building.model")  # told apart by their content

# -- what was written (src/store/tables.c) -----------------------------------------------------------------------------

_APPLICATION, _FORMAT = 0x494D5445, 10
_SEED, _PRIME, _MASK = 0xCBF29CE484222325, 0x100000001B3, (1 << 64) - 1


def _digest(values: Any, digest: int = _SEED) -> int:
    """FNV-1a of the program: of whole numbers and floats a word at a time, of texts by bytes, to the 0 behind them."""
    for value in values:
        if isinstance(value, str):
            for byte in value.encode() + b"\0":
                digest = (digest ^ byte) * _PRIME & _MASK
        else:
            word = value if isinstance(value, int) else struct.unpack("q", struct.pack("d", value + 0.0))[0]
            digest = (digest ^ word & _MASK) * _PRIME & _MASK
            digest ^= digest >> 32
    return digest


def _is_whole(row: Any, declared: list[str]) -> bool:
    """A row of evaluation or finer is what was written: its digest stands between its fields and its numbers."""
    at = declared.index("digest INTEGER")
    real = [-1e308 if value is None else value for value in row]
    values = [real[i] if kind.endswith("REAL") else row[i] for i, kind in enumerate(declared) if i != at]
    joined = 0
    if declared[2] == "kind TEXT":  # kind and generation change later: their digest is joined by exclusive or
        joined = _digest([row[1], row[2]]) if row[2] is not None else 0
        values[1:3] = [0]
    return bool(_digest(values) ^ joined == row[at] & _MASK)


class Run(Copied, Tabular):
    """A run of `imtet optimize`, read from its run.sqlite; it may be under way.

    Attributes
    ----------
    designs : numpy.recarray
        Every evaluated design: id, generation, kind, outcome, variables, objectives, other results. Designs that the study
        has named have their values at finer steps, as everywhere in the program.
    front : numpy.recarray
        The designs on the front, as in front.csv.
    knee : numpy.record
        The design nearest to the ideal point, each objective scaled to 0..1 over the front.
    settings : dict
        Text of every "section.key".
    variables, objectives : list of str
    """

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        name = os.path.join(path, "run.sqlite")
        if not os.path.exists(name):
            raise FileNotFoundError(f"{path}: no run is there (run.sqlite)")
        db = sqlite3.connect(f"file:{os.path.abspath(name)}?mode=ro", uri=True)
        try:
            self._check(db)
            self._read(db)
        except sqlite3.DatabaseError as fault:
            raise ImtetError(7, f"{name}: {fault}") from None
        finally:
            db.close()
        self._scenes: dict[int, Scene] = {}

    def _fail(self, status: int, words: str) -> ImtetError:
        return ImtetError(status, f"{self.path}/run.sqlite: {words}")

    def _check(self, db: sqlite3.Connection) -> None:
        """As the program does: ours, of the known format, tables alone (a view could compute rows without end), whole."""
        def first(sql: str) -> Any:
            return db.execute(sql).fetchone()[0]
        db.execute("PRAGMA trusted_schema = OFF")
        if first("PRAGMA application_id") != _APPLICATION:
            raise self._fail(2, "is no database of a run")
        if first("PRAGMA user_version") != _FORMAT:
            raise self._fail(7, f"has format {first('PRAGMA user_version')}, this package reads {_FORMAT}")
        if first("SELECT count(*) FROM sqlite_master WHERE type <> 'table' OR coalesce(rootpage, 0) < 2 OR "
                 "sql LIKE '%virtual%'"):
            raise self._fail(7, "is no database of a run: it holds views or triggers")
        if first("PRAGMA quick_check(1)") != "ok":
            raise self._fail(7, "is damaged: " + first("PRAGMA quick_check(1)"))

    def _rows(self, db: sqlite3.Connection, table: str) -> tuple[list[str], dict[int, Any]]:
        """Names of the columns, and rows by their ids, each of which is what was written."""
        columns = db.execute(f"PRAGMA table_info({table})").fetchall()
        declared, rows = [f"{column[1]} {column[2]}" for column in columns], {}
        for row in db.execute(f"SELECT * FROM {table} ORDER BY id"):
            if not _is_whole(row, declared):
                raise self._fail(7, f"is damaged: {table} {row[0]} is not what was written")
            rows[row[0]] = row
        return [column[1] for column in columns], rows

    def _read(self, db: sqlite3.Connection) -> None:
        db.execute("BEGIN")  # one state of a run that is worked on
        head = db.execute("SELECT settings, provenance, planned_evals, n_var, digest FROM run").fetchone()
        if _digest(head[:4]) != head[4] & _MASK:
            raise self._fail(7, "is damaged: its settings are not what was written")
        parser = configparser.RawConfigParser(delimiters="=", comment_prefixes=";")
        parser.read_string(head[0])
        self.settings = {f"{section}.{key}": value for section in parser for key, value in parser[section].items()}
        self.inputs = json.loads(head[1]).get("inputs", {})
        columns, rows = self._rows(db, "evaluation")
        columns_finer, finer = self._rows(db, "finer")
        marks = {row[0] for row in db.execute("SELECT evaluation FROM front WHERE left IS NULL")}
        last = db.execute("SELECT members, simulated FROM generation ORDER BY number DESC LIMIT 1").fetchone()
        if last and functools.reduce(operator.xor, (_digest([i]) for i in marks), 0) != last[0] & _MASK:
            raise self._fail(7, "is damaged: its front is not what was written")
        if last and not rows.keys() >= set(range(1, last[1] + 1)):
            raise self._fail(7, "is damaged: an evaluation is missing")
        marks = {row[0] for row in db.execute("SELECT evaluation FROM front")} if finer else marks
        self._marks, self._levels = marks, {i: row[columns_finer.index("level")] for i, row in finer.items()}
        names = columns[columns.index("digest") + 1:]
        self.variables: list[str] = names[:head[3]]
        self.objectives: list[str] = [n for n in names[head[3]:] if n + "_sd" in columns_finer]
        self._signs = [self._sense(k, n) for k, n in enumerate(self.objectives)]
        better = {columns.index(n): k for k, n in enumerate(columns_finer)
                  if n == "violation" or n in names and n not in self.variables}
        chosen = [columns.index(n) for n in ("id", "generation", "kind", "outcome", "violation", *names)]
        kept = sorted((row for row in rows.values() if row[2] is not None), key=lambda row: row[2] in _OUTSIDE)

        def value(row: Any, k: int) -> Any:
            fine = finer.get(row[0])
            best = fine[better[k]] if fine and k in better and fine[better[k]] is not None else row[k]
            return np.nan if best is None else best
        kinds: Any = [("id", "i8"), ("generation", "i8"), ("kind", "U12"), ("outcome", "U16"), ("violation", "f8"),
                      *((n, "f8") for n in names)]
        self.designs: Records = np.array([tuple(value(row, k) for k in chosen) for row in kept], kinds).view(np.recarray)

    def __repr__(self) -> str:
        return f"<imtet.Run {self.path}: {len(self.designs)} designs, objectives {', '.join(self.objectives)}>"

    def _sense(self, k: int, name: str) -> float:
        if self.settings["problem.kind"] == "tower":
            return -1.0 if name in _MORE_IS_BETTER else 1.0
        words = self.settings["problem.senses"].replace(" ", "").split(",")
        return -1.0 if words[k if len(words) > 1 else 0] == "max" else 1.0

    def _minimised(self, d: Any) -> Array:
        return np.column_stack([d[n] for n in self.objectives]) * self._signs

    @property
    def front(self) -> Records:
        """Record array of the designs on the front, by ascending ids."""
        d = self.designs
        if self.settings["problem.noisy"] == "yes":
            raise NotImplementedError("the front of a noisy problem has means of evaluations: read front.csv")
        with np.errstate(invalid="ignore"):
            wanted = (d.outcome == "ok") & ~(d.violation > 0)
        wanted &= np.isin(d.id, [*self._marks]) | np.isin(d.kind, _OUTSIDE)
        d = d[wanted]
        front: Records = d[self._is_nondominated(d)]
        return front

    def _is_nondominated(self, d: Any) -> npt.NDArray[np.bool_]:
        F = self._minimised(d)
        return np.array([not np.any(np.all(F <= f, axis=1) & np.any(F < f, axis=1)) for f in F], dtype=bool)

    def best(self, objective: str) -> Any:
        """The design of the front that is best in an objective: run.best("j1_m")."""
        if objective not in self.objectives:
            raise KeyError(f"{objective!r} is not an objective of this run; it has {', '.join(self.objectives)}")
        front = self._front()
        return front[self._minimised(front)[:, self.objectives.index(objective)].argmin()]

    @property
    def knee(self) -> Any:
        """The design of the front nearest to the ideal point, each objective scaled to 0..1 over the front."""
        front = self._front()
        F = self._minimised(front)
        spread = np.ptp(F, axis=0)
        return front[(((F - F.min(axis=0)) / np.where(spread > 0, spread, 1)) ** 2).sum(axis=1).argmin()]

    def _front(self) -> Records:
        front = self.front
        if len(front) == 0:
            raise ValueError(f"{self.path}: no design is on its front")
        return front

    def design(self, number: int) -> Any:
        """The row of the design with this id."""
        if not isinstance(number, (int, np.integer)):
            raise KeyError(f"{number!r} is not an id, a whole number of run.designs.id or run.front.id")
        rows = self.designs[self.designs.id == number]
        if len(rows) == 0:
            raise KeyError(f"no design has the id {number}")
        return rows[0]

    def simulate(self, number: int) -> Result:
        """Simulate a design of a tower again, by its id, with as many steps as the run knows it by: that of `designs`."""
        if self.settings["problem.kind"] != "tower":
            raise ValueError("the problem of this run is not a tower: `imtet simulate` asks its worker")
        row, level = self.design(number), self._levels.get(number, 0)
        if level not in self._scenes:
            accuracy: Any = self.settings["sim.accuracy"]
            if level and accuracy != "fine":  # times that the steps are doubled, which go with the error^(-2/3)
                accuracy = (_ERRORS.get(accuracy) or float(accuracy)) * 2 ** (-1.5 * level)
            self._scenes[level] = Scene(None, **{**self.settings, "sim.accuracy": accuracy})
        return self._scenes[level].simulate(np.array([row[n] for n in self.variables]))

    def verdict(self, number: int) -> str:
        """What a design of a tower comes to, a sentence a line, where a command has judged it: the end of the study its knee."""
        try:
            with open(os.path.join(self.path, "verdicts.json")) as file:
                text: str = json.load(file)[f"{number}"]
        except (OSError, KeyError):
            raise KeyError(f"no verdict is stored: `imtet report {self.path} --design {number}` finds it") from None
        return text.replace(" RUN ", f" {shlex.quote(self.path)} ")

    def _table(self) -> Any:
        d = self.designs
        columns = {name: d[name] for name in d.dtype.names or () if name != "id"}
        return columns, d.id, self.objectives, self._signs, np.isin(d.id, self.front.id), (d.outcome == "ok") & ~(d.violation > 0)


def open_run(path: Path) -> Run:
    """The `Run` of a folder that `imtet optimize` made."""
    return Run(path)


def merge_fronts(*paths: Path) -> tuple[Records, npt.NDArray[np.int64]]:
    """Merge the fronts of several runs of one problem, else ValueError; a design of several runs appears once.

    Returns
    -------
    front : numpy.recarray
    of : numpy.ndarray of int
        Number 0, 1, ... of the run of each row.
    """
    runs = [Run(p) for p in paths]
    if not runs:
        raise ValueError("no run was given")

    def problem(run: Run) -> dict[str, Any]:
        kept = {k: v for k, v in run.settings.items() if not k.startswith(_NOT_OF_THE_PROBLEM) and k not in _FILES}
        kept.update((k, v) for k, v in run.inputs.items() if k.endswith("_fnv1a"))
        return {**kept, **{k: run.settings[k] for k in ("search.objectives", "search.limits")}}
    first = problem(runs[0])
    for path, run in zip(paths, runs):
        other = problem(run)
        differs = [f"{k} {first.get(k)} and {other.get(k)}" for k in {**first, **other} if first.get(k) != other.get(k)]
        if differs or run.variables != runs[0].variables:
            raise ValueError(f"{paths[0]!s} and {path!s} are runs of two problems: " + ("; ".join(differs) or "other variables"))
    fronts = [np.asarray(r.front) for r in runs]
    rows, of = np.concatenate(fronts), np.repeat(np.arange(len(runs)), [len(f) for f in fronts])
    X = np.column_stack([rows[n] for n in runs[0].variables])
    once = np.sort(np.unique(X, axis=0, return_index=True)[1])
    keep = once[runs[0]._is_nondominated(rows[once])]
    return rows[keep].view(np.recarray), of[keep]
