"""imtet: Pareto fronts by few evaluations, and the simulation of towers that collide with a core, from Python.

One file over libimtet.so by ctypes; needs numpy alone. Arrays are float64; rows of X are designs, rows of F what they are
worth, in natural signs and units. Errors of the library are ImtetError with a sentence that says what to do. Calls give
up the lock of the interpreter, so that threads may simulate side by side, and Ctrl-C ends what is under way as soon as
the call returns (milliseconds; choosing designs takes some 10 ms to seconds).

    import imtet
    search = imtet.Search(lower=[0] * 6, upper=[1] * 6, objectives=2, evaluations=200)
    while not search.done:
        X = search.ask(8)
        search.tell(X, search.evaluate(f, X))     # f(x) -> two numbers; an exception or None: the design failed
    F, X = search.front()
"""
import concurrent.futures
import configparser
import ctypes
import ctypes.util
import difflib
import json
import os
import sqlite3

import numpy as np

__all__ = ["Search", "Scene", "Result", "Run", "open_run", "merge_fronts", "read_motion", "version", "ImtetError"]


class ImtetError(Exception):
    """What the library says. `status`: MISUSED 1, BAD_DATA 2, MISSING 3, INTERNAL 5, NO_MEMORY 6, IO 7 (imtet.h)."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


# -- the library -------------------------------------------------------------------------------------------------------

class _Error(ctypes.Structure):
    _fields_ = [("status", ctypes.c_int), ("text", ctypes.c_char * 480)]


_doubles = ctypes.POINTER(ctypes.c_double)
_words = ctypes.POINTER(ctypes.c_char_p)
_size, _handle = ctypes.c_size_t, ctypes.c_void_p


class _Options(ctypes.Structure):
    _fields_ = [("size", _size), ("variables", _size), ("objectives", _size), ("constraints", _size),
                ("lower", _doubles), ("upper", _doubles), ("kinds", ctypes.c_char_p), ("senses", ctypes.c_char_p),
                ("starts", _size), ("start", _doubles), ("settings", _words)]


class _State(ctypes.Structure):
    _fields_ = [("size", _size), ("variables", _size), ("objectives", _size), ("constraints", _size), ("told", _size),
                ("failed", _size), ("under_way", _size), ("left", _size), ("done", ctypes.c_int),
                ("why", ctypes.c_char_p)]


def _library():
    """IMTET_LIBRARY, what was built beside this file, or what is installed."""
    here = os.path.dirname(os.path.abspath(__file__))
    names = [os.environ.get("IMTET_LIBRARY"), os.path.join(here, "..", "build", "release", "libimtet.so"),
             "libimtet.so.0", "/usr/local/lib/libimtet.so.0", ctypes.util.find_library("imtet")]
    faults = []
    for name in filter(None, names):
        if os.path.sep in name and not os.path.exists(name) and name != names[0]:
            continue
        try:
            return ctypes.CDLL(name)
        except OSError as fault:
            faults.append(str(fault))
            if name == names[0]:
                break
    raise ImportError("libimtet.so is not to be found (make && sudo make install, or its path in IMTET_LIBRARY): "
                      + "; ".join(faults))


_lib = _library()
_lib.imtet_version.restype = ctypes.c_char_p
_lib.imtet_result_name.restype = _lib.imtet_result_text.restype = ctypes.c_char_p
_lib.imtet_result_name.argtypes = [_handle, _size]
_lib.imtet_result_text.argtypes = [_handle, ctypes.c_char_p]
_lib.imtet_search_free.restype = _lib.imtet_scene_free.restype = _lib.imtet_result_free.restype = None

version = _lib.imtet_version().decode()


def _call(name, *arguments):
    error = _Error()
    if getattr(_lib, name)(*arguments, ctypes.byref(error)):
        raise ImtetError(error.status, error.text.decode(errors="replace"))


def _pointer(array):
    return None if array is None else array.ctypes.data_as(_doubles)


def _list(words):
    words = [os.fsencode(w) for w in words]
    return (ctypes.c_char_p * (len(words) + 1))(*words, None)


def _text(words):
    """One word for all, or a list of them."""
    return None if words is None else (words if isinstance(words, str) else ",".join(words)).encode()


def _assignments(section, settings):
    """{"population": 40, "sim.forces": "yes"} as "section.key=value"."""
    words = {True: "on", False: "off"}
    return [f"{key if '.' in key else section + '.' + key}={words.get(value, value) if isinstance(value, bool) else value}"
            for key, value in settings.items()]


def _numbers(what, values, wanted):
    """An array of float64, or ValueError with the shape that is wanted."""
    try:
        return np.asarray(values, dtype=np.float64, order="C")
    except (TypeError, ValueError) as fault:
        raise ValueError(f"{what}: {fault}; wanted numbers of shape {wanted}") from None


def _matrix(what, values, columns):
    """(n, columns); one row of them may be a plain list."""
    array = _numbers(what, values, f"(n, {columns})")
    if array.ndim == 1 and array.size == columns:
        array = array.reshape(1, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{what} has shape {array.shape}, wanted (n, {columns})")
    return array


def _row(what, values, n):
    """(n,); where n is 1 a number will do."""
    array = _numbers(what, values, f"({n},)")
    if array.shape != (n,) and not (n == 1 and array.ndim == 0):
        raise ValueError(f"{what} has shape {array.shape}, wanted ({n},)")
    return array


def _rows(what, values, n, columns):
    """A list of n rows, whatever each of them is."""
    try:
        rows = list(values)
    except TypeError:
        raise ValueError(f"{what} is {values!r}, wanted rows of shape ({n}, {columns})") from None
    if len(rows) != n:
        raise ValueError(f"X has {n} rows, {what} {len(rows)}: wanted shape ({n}, {columns})")
    return rows


class _Handle:
    """What the library owns has one owner here: a copy would free it once more."""

    def __reduce_ex__(self, protocol):
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled: {self._instead}")


class _Copied:
    """Values; the scene behind them stays with the original."""

    def __getstate__(self):
        return {**self.__dict__, "_scene": None}


# -- the search --------------------------------------------------------------------------------------------------------

class Search(_Handle):
    """The Pareto front of `objectives` functions of len(lower) variables, by `evaluations` designs at most.

    lower, upper  (variables,) bounds
    constraints   how many G of a design must be at most 0
    kinds         "real", "log", "int" or "choice:steel|oak", one for all variables or a list; a choice is 0, 1, ... in X
    senses        "min" or "max", one for all objectives or a list
    start         (n, variables) designs to begin with
    settings      of [search] as `imtet settings` lists them: population=40, stop_after=300, aspire="f1 0.5,f2 3" (objectives
                  are f1, f2, ...) ...

    Same arguments and answers: the same designs to the last bit, however many are asked for at a time, in whatever order
    they are told, saved and loaded in between or not.
    """

    _instead = "save it, and imtet.Search.load the file wherever it is wanted again"

    def __init__(self, lower, upper, objectives, kinds=None, seed=1, evaluations=500, constraints=0, senses=None,
                 start=None, **settings):
        self._search = _handle()
        lower = np.ascontiguousarray(lower, dtype=np.float64).ravel()
        upper = np.ascontiguousarray(upper, dtype=np.float64).ravel()
        if lower.size != upper.size:
            raise ValueError(f"lower has {lower.size} numbers, upper {upper.size}")
        for what, number in (("objectives", objectives), ("constraints", constraints)):
            if not isinstance(number, (int, np.integer)) or number < (what == "objectives"):
                raise ValueError(f"{what} is {number!r}, wanted a whole number of {int(what == 'objectives')} or more")
        start = None if start is None else _matrix("start", start, lower.size)
        settings = _list(_assignments("search", {"seed": seed, "max_evals": evaluations, **settings}))
        options = _Options(ctypes.sizeof(_Options), lower.size, objectives, constraints, _pointer(lower),
                           _pointer(upper), _text(kinds), _text(senses), 0 if start is None else len(start),
                           _pointer(start), settings)
        _call("imtet_search_create", ctypes.byref(options), ctypes.byref(self._search))
        self._open()

    def _open(self):
        state = self._look()
        self.variables, self.objectives, self.constraints = state.variables, state.objectives, state.constraints
        self._ids = {}

    @classmethod
    def load(cls, path):
        """A search that `save` wrote, as it was then; designs that were asked for and not told are asked for again."""
        self = cls.__new__(cls)
        self._search = _handle()
        _call("imtet_search_load", os.fsencode(path), ctypes.byref(self._search))
        self._open()
        return self

    def save(self, path):
        """Everything into a file, which is replaced when the new one is whole on the disk: a kill loses nothing."""
        _call("imtet_search_save", self._search, os.fsencode(path))

    def __del__(self):
        if getattr(self, "_search", None):
            _lib.imtet_search_free(ctypes.byref(self._search))

    def _look(self):
        state = _State(ctypes.sizeof(_State))
        _call("imtet_search_look", self._search, ctypes.byref(state))
        return state

    @property
    def done(self):
        """True: nothing more will be asked for."""
        return bool(self._look().done)

    @property
    def state(self):
        """Counts: told, failed, under_way (asked for and not told), left (of evaluations), done, and why."""
        s = self._look()
        return {"told": s.told, "failed": s.failed, "under_way": s.under_way, "left": s.left, "done": bool(s.done),
                "why": s.why.decode()}

    def ask(self, n=1):
        """X (m, variables), m <= n: designs nobody has asked for. m = 0 where the search is done, or waits for answers:
        it goes on when the first of those under way are told."""
        if not isinstance(n, (int, np.integer)) or n < 0:
            raise ValueError(f"n is {n!r}, wanted an int: how many designs")
        n = min(int(n), 1 << 20)
        X, ids, found = np.empty((n, self.variables)), (ctypes.c_long * max(n, 1))(), _size()
        _call("imtet_search_ask", self._search, n, ids, _pointer(X), ctypes.byref(found))
        X = X[:found.value]
        self._ids.update((x.tobytes(), ids[i]) for i, x in enumerate(X))
        return X.copy()

    def tell(self, X, Y, G=None):
        """What designs are worth. X (n, variables) as asked for, in any order; Y: n rows of `objectives` numbers, where
        a row is None or an exception the design failed; with constraints a row is a pair (f, g), or G (n, constraints)
        has their values. Refused as a whole where a shape is wrong or a number is not finite."""
        X = _matrix("X", X, self.variables)
        Y = _rows("Y", Y, len(X), self.objectives)
        G = None if G is None else _rows("G", G, len(X), self.constraints)
        if len(X) == 0 and self._ids:
            raise ImtetError(1, f"{len(self._ids)} designs were asked for and never told, so that nothing is left to ask: tell "
                             "them, or save the search and load it, which asks for them again")
        keys = [x.tobytes() for x in X]
        for i, key in enumerate(keys):
            if key not in self._ids:
                raise ValueError(f"row {i} of X was not asked for, or is told already")
        F, H = np.zeros((len(X), self.objectives)), np.zeros((len(X), self.constraints))
        failed = (ctypes.c_char_p * max(len(X), 1))()
        for i, y in enumerate(Y):
            if y is None or isinstance(y, BaseException):
                failed[i] = _reason(y).encode(errors="replace")
                continue
            if self.constraints > 0 and G is None and not self._is_pair(y):
                raise ValueError(f"row {i} of Y is no tuple (f, g), and there is no G of shape ({len(X)}, {self.constraints})")
            f, g = y if self._is_pair(y) else (y, G[i] if G is not None else ())
            F[i] = _row(f"row {i} of Y", f, self.objectives)
            H[i] = _row(f"row {i} of G", g, self.constraints)
        ids = (ctypes.c_long * max(len(X), 1))(*(self._ids[k] for k in keys))
        _call("imtet_search_tell", self._search, len(X), ids, _pointer(F), _pointer(H), failed)
        for key in keys:
            del self._ids[key]

    def _is_pair(self, y):
        return self.constraints > 0 and isinstance(y, tuple) and len(y) == 2 and (self.objectives == 1 or np.ndim(y[0]) == 1)

    def evaluate(self, f, X, threads=1):
        """[f(x) for x of X], for tell. Where f raises, returns None, or numbers that are not finite, the design failed;
        the others go on. threads: so many calls at a time, which helps where f gives up the lock of the interpreter."""
        def answer(x):
            try:
                y = f(x)
                if y is None:
                    return None
                parts = y if self._is_pair(y) else (y,)
                finite = all(np.all(np.isfinite(np.asarray(part, dtype=np.float64))) for part in parts)
                return y if finite else ArithmeticError("the answer is not finite")
            except Exception as fault:  # of this design alone
                return fault
        if threads < 2:
            return [answer(x) for x in X]
        with concurrent.futures.ThreadPoolExecutor(threads) as pool:
            return list(pool.map(answer, X))

    def _designs(self, which):
        found = _size()
        _call("imtet_search_designs", self._search, which, 0, None, None, None, None, ctypes.byref(found))
        n = found.value
        ids, X = (ctypes.c_long * max(n, 1))(), np.empty((n, self.variables))
        F, G = np.empty((n, self.objectives)), np.empty((n, self.constraints))
        _call("imtet_search_designs", self._search, which, n, ids, _pointer(X), _pointer(F), _pointer(G),
              ctypes.byref(found))
        return F, X, G

    def front(self):
        """F (n, objectives), X (n, variables): the designs that keep all constraints and are dominated by no other."""
        return self._designs(0)[:2]

    def told(self):
        """F, X, G of all designs told, in the order of asking; F and G are NaN where a design failed."""
        return self._designs(1)


def _reason(fault):
    return "None was answered" if fault is None else f"{type(fault).__name__}: {fault}"


# -- the simulator -----------------------------------------------------------------------------------------------------

class Result(_Copied):
    """Named numbers, arrays and texts of the library, as attributes: r.j1_m, r.peak_drift_m, r.outcome. `names` lists
    them; units stand at the ends of the names. One number is a float, a column an array (n,), a table (rows, columns)."""

    def __init__(self, handle, scene=None, question=None):
        self.names, self._scene, self._question = [], scene, question
        numbers, rows, columns = _doubles(), _size(), _size()
        try:
            for name in iter(lambda: _lib.imtet_result_name(handle, len(self.names)), None):
                text = _lib.imtet_result_text(handle, name)
                self.names.append(name.decode())
                if text is not None:
                    setattr(self, self.names[-1], text.decode(errors="replace"))
                    continue
                _call("imtet_result_numbers", handle, name, ctypes.byref(numbers), ctypes.byref(rows),
                      ctypes.byref(columns))
                n, m = rows.value, columns.value
                array = np.ctypeslib.as_array(numbers, (n, m)).copy() if n * m > 0 else np.empty((n, m))
                setattr(self, self.names[-1], array if m > 1 else float(array[0, 0]) if n == 1 else array[:, 0])
        finally:
            _lib.imtet_result_free(ctypes.byref(handle))

    def __getattr__(self, name):
        names = self.__dict__.get("names", [])
        near = [n for n in names if n.startswith(name)] or difflib.get_close_matches(name, names, 1)
        raise AttributeError(f"no result is called {name}; " + (f"did you mean {near[0]}? " if near else "")
                             + f"there are {', '.join(names)}")

    def __getitem__(self, name):
        return getattr(self, name)

    def __repr__(self):
        return "Result(" + ", ".join(f"{n}={getattr(self, n):.6g}" for n in self.names
                                     if isinstance(getattr(self, n), float) and not np.isnan(getattr(self, n))) + ")"

    def history(self, every=0.0):
        """The same response over time, simulated once more: a Result of t_s (n,), floor_m, accel_g, core_m, contact_n
        (n, floors) and energies. every: seconds between rows at most; None or 0: the step of the motion."""
        if self._scene is None:
            raise ValueError("this result is no response, or a copy, which has no scene")
        if every and not (isinstance(every, (int, float, np.number)) and 1e-5 <= every <= 1e6):
            raise ValueError(f"every is {every!r}, wanted seconds from 1e-5 to 1e6, or 0 for the step of the motion")
        kind, x = self._question
        return self._scene._ask("imtet_scene_history", kind, _pointer(x), 0 if x is None else x.size,
                                ctypes.c_double(every or 0))


class Scene(_Handle):
    """A tower, the core inside it and a ground motion, of a settings file (None: the defaults) and settings by name:

        Scene("configs/kobe.ini", record="KOBE.AT2", **{"sim.forces": "yes"})

    record and keys without a section are those of [motion]: record, unit, pga_g, stretch ... `imtet settings` has all.
    variables, lower, upper (n,): what a design x is and the box of a search; objectives, senses; floors. Threads may
    simulate on one scene at once.
    """

    _instead = "open another imtet.Scene of the same settings; threads may share one"

    def __init__(self, path=None, settings=(), **changes):
        self._scene = _handle()
        changes = {k: os.path.abspath(v) if k in ("record", "motion.record") and os.path.exists(v) else v
                   for k, v in changes.items()}
        _call("imtet_scene_open", None if path is None else os.fsencode(path),
              _list([*settings, *_assignments("motion", changes)]), ctypes.byref(self._scene))
        about = self._ask("imtet_scene_describe")
        self.variables, self.objectives = about.variables.split(","), about.objectives.split(",")
        self.senses, self.floors, self.record = about.senses.split(","), int(about.floors), about.record
        self.lower, self.upper = np.atleast_1d(about.lower), np.atleast_1d(about.upper)
        self.building_hz = np.atleast_1d(about.building_hz)

    def __del__(self):
        if getattr(self, "_scene", None):
            _lib.imtet_scene_free(ctypes.byref(self._scene))

    def _ask(self, function, *arguments, question=None):
        handle = _handle()
        _call(function, self._scene, *arguments, ctypes.byref(handle))
        return Result(handle, self if question else None, question)

    def design(self, gaps=None, thickness=None, **others):
        """x (n,) of gaps [m] (one number for all, or one of each), thickness [m] (one number, or that at the foot and at
        the top), and further variables by their names: side_m=9."""
        given = {name: _row(name, value, 1).item() for name, value in others.items()}
        for what, values, start in (("gaps", gaps, "gap_"), ("thickness", thickness, "t_")):
            names = [n for n in self.variables if n.startswith(start)] or [what]
            if values is not None:
                values = _numbers(what, values, f"() or ({len(names)},)")
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

    def simulate(self, x=None, *, gaps=None, thickness=None, kind="with_core", **others):
        """The Result of a design x (n,), or of gaps=, thickness= as `design` has them: j1_m, j2_m, j3_g, ..., per floor
        peak_displacement_m, peak_drift_m, peak_acceleration_g; outcome is "ok", or the numbers are not to be used.
        kind: "with_core", or what it is compared with: "no_core" (the building alone), "rigid" (rigidly connected), "tmd"
        (tuned mass damper), "links" (viscous links), the last two with the device that does best."""
        named = {k: v for k, v in {"gaps": gaps, "thickness": thickness, **others}.items() if v is not None}
        if x is not None and named:
            raise TypeError(f"x and {', '.join(named)} are given: give x alone, or no x; scene.design({next(iter(named))}=...) "
                            "makes an x")
        if named or (x is None and kind != "no_core"):
            x = self.design(**named)
        x = None if x is None else _row("x", x, len(self.variables))
        return self._ask("imtet_scene_simulate", _text(kind), _pointer(x), 0 if x is None else x.size, question=(_text(kind), x))

    def evaluate(self, x):
        """The objectives of the scene (len(objectives),), for Search.evaluate; raises where the simulation fails."""
        r = self.simulate(x)
        if r.outcome != "ok":
            raise ArithmeticError(r.reason)
        return [r[name] for name in self.objectives]


def read_motion(path, **settings):
    """dt [s], acceleration (n,) [m/s2] and a dict of name, format, channel, processed, warning of a record in any format
    that the program reads, or builtin:NAME. settings of [motion]: unit="g", channel=2, pga_g=0.3; as recorded without."""
    handle = _handle()
    _call("imtet_motion_read", os.fsencode(path), _list(_assignments("motion", settings)), ctypes.byref(handle))
    r = Result(handle)
    meta = {name: r[name] for name in r.names if isinstance(r[name], str)}
    return r.dt_s, np.atleast_1d(r.acceleration), meta


# -- runs --------------------------------------------------------------------------------------------------------------

_MORE_IS_BETTER = {"ed5_10_pct", "edcs_pct", "ed_devices_pct"}  # of a tower's measures


class Run(_Copied):
    """A run of `imtet optimize`, read from its run.sqlite; it may be under way.

    designs  record array of every evaluated design: id, generation, kind, outcome, variables, objectives, what else was
             measured; of designs that the study has named the values at finer steps, as everywhere in the program
    front    those on the front, as in front.csv
    settings dict of "section.key" to its text
    """

    def __init__(self, path):
        name = os.path.join(path, "run.sqlite")
        if not os.path.exists(name):
            raise FileNotFoundError(f"{path}: " + ("no run is there (run.sqlite)" if os.path.isdir(path) else "there is no such folder"))
        db = sqlite3.connect(f"file:{os.path.abspath(name)}?mode=ro", uri=True)
        try:
            self._read(db)
        finally:
            db.close()
        self._scenes = {}

    def _read(self, db):
        text, n_var, provenance = db.execute("SELECT settings, n_var, provenance FROM run").fetchone()
        parser = configparser.RawConfigParser(delimiters="=", comment_prefixes=";")
        parser.read_string(text)
        self.settings = {f"{section}.{key}": value for section in parser for key, value in parser[section].items()}
        self.inputs = json.loads(provenance).get("inputs", {})
        columns = [row[1] for row in db.execute("PRAGMA table_info(evaluation)")]
        finer = [row[1] for row in db.execute("PRAGMA table_info(finer)")]
        numbers = columns[columns.index("digest") + 1:]
        self.variables = numbers[:n_var]
        self.objectives = [n for n in numbers[n_var:] if n + "_sd" in finer]
        better = {n: f'COALESCE(f."{n}", e."{n}")' for n in numbers if n in finer and n not in self.variables}
        chosen = ", ".join([better.get(n, f'e."{n}"') for n in numbers])
        rows = db.execute(f"SELECT e.id, e.generation, e.kind, e.outcome, COALESCE(f.violation, e.violation), {chosen} "
                          "FROM evaluation e LEFT JOIN finer f ON f.id = e.id WHERE e.kind IS NOT NULL "
                          "ORDER BY e.kind = 'polished', e.id").fetchall()
        self._levels = dict(db.execute("SELECT id, level FROM finer"))
        named = bool(self._levels)
        marks = {row[0] for row in db.execute("SELECT evaluation FROM front" + ("" if named else " WHERE left IS NULL"))}
        kinds = [("id", np.int64), ("generation", np.int64), ("kind", "U12"), ("outcome", "U16"),
                 ("violation", np.float64)] + [(n, np.float64) for n in numbers]
        table = np.array([tuple(np.nan if v is None else v for v in row) for row in rows], dtype=kinds)
        self.designs = table.view(np.recarray)
        self._marks = marks

    def _sense(self, k, name):
        if self.settings["problem.kind"] == "tower":
            return -1.0 if name in _MORE_IS_BETTER else 1.0
        words = [w.strip() for w in self.settings["problem.senses"].split(",")]
        return -1.0 if words[k if len(words) > 1 else 0] == "max" else 1.0

    @property
    def front(self):
        """Record array of the designs on the front, by ascending ids."""
        d = self.designs
        if self.settings["problem.noisy"] == "yes":
            raise NotImplementedError("of a noisy problem the front has means of evaluations: read front.csv")
        with np.errstate(invalid="ignore"):
            wanted = (d.outcome == "ok") & ~(d.violation > 0)
        wanted &= np.array([i in self._marks for i in d.id], dtype=bool) | (d.kind == "polished")
        d = d[wanted]
        return d[self._is_nondominated(d)]

    def _is_nondominated(self, d):
        F = np.column_stack([self._sense(k, n) * d[n] for k, n in enumerate(self.objectives)])
        return np.array([not np.any(np.all(F <= f, axis=1) & np.any(F < f, axis=1)) for f in F], dtype=bool)

    def design(self, number):
        """Row of the design of that id."""
        if not isinstance(number, (int, np.integer)):
            raise KeyError(f"{number!r} is no id, a whole number of run.designs.id or run.front.id")
        rows = self.designs[self.designs.id == number]
        if len(rows) == 0:
            raise KeyError(f"no design has the id {number}")
        return rows[0]

    def simulate(self, number):
        """The Result of a design of a tower by its id, simulated again as the run simulates: a design that its end named
        with more steps, so that the numbers are those of `designs`."""
        if self.settings["problem.kind"] != "tower":
            raise ValueError("the problem of this run is no tower: `imtet simulate` asks its worker")
        row, level = self.design(number), self._levels.get(number, 0)
        if level not in self._scenes:
            accuracy = self.settings["sim.accuracy"]
            if level and accuracy != "fine":  # times that the steps are doubled, which go with the error^(-2/3)
                accuracy = (_ERRORS.get(accuracy) or float(accuracy)) * 2 ** (-1.5 * level)
            self._scenes[level] = Scene(None, **{**self.settings, "sim.accuracy": accuracy})
        return self._scenes[level].simulate(np.array([row[n] for n in self.variables]))


def open_run(path):
    """The Run of a folder that `imtet optimize` made."""
    return Run(path)


_ERRORS = {"coarse": 0.08, "standard": 0.01}  # as numbers, by their steps per contact
_NOT_OF_THE_PROBLEM = ("search.", "run.", "problem.command", "problem.timeout_s", "sim.threads")
_FILES = ("motion.record", "motion.records", "motion.forces", "building.model")  # told apart by their content


def merge_fronts(*paths):
    """The front of several runs of one problem: (record array, array of the run's number 0, 1, ... of each row). A design
    that several runs have stands there once. ValueError where the problems differ, with what differs."""
    runs = [Run(p) for p in paths]
    if not runs:
        raise ValueError("no run was given")

    def problem(run):
        kept = {k: v for k, v in run.settings.items() if not k.startswith(_NOT_OF_THE_PROBLEM) and k not in _FILES}
        kept.update((k, v) for k, v in run.inputs.items() if k.endswith("_fnv1a"))
        return {**kept, **{k: run.settings[k] for k in ("search.objectives", "search.limits")}}
    first = problem(runs[0])
    for path, run in zip(paths, runs):
        other = problem(run)
        differs = [f"{k} {first.get(k)} and {other.get(k)}" for k in {**first, **other} if first.get(k) != other.get(k)]
        if differs or run.variables != runs[0].variables:
            raise ValueError(f"{paths[0]} and {path} are runs of two problems: " + ("; ".join(differs) or "other variables"))
    fronts = [np.asarray(r.front) for r in runs]
    rows, of = np.concatenate(fronts), np.repeat(np.arange(len(runs)), [len(f) for f in fronts])
    X = np.column_stack([rows[n] for n in runs[0].variables])
    once = np.sort(np.unique(X, axis=0, return_index=True)[1])
    rows, of = rows[once], of[once]
    keep = runs[0]._is_nondominated(rows)
    return rows[keep].view(np.recarray), of[keep]
