"""The search: ask for designs, tell their objectives."""
from __future__ import annotations

import concurrent.futures
import ctypes
import os
import secrets
import threading
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _library as library
from ._library import Array, Catch, ImtetError, Path, State, call, pointer
from ._tables import Tabular, frame

_CLOSE = 1e-6  # share of the box: rows that differ by less are one design
_SENSES = {"minimize": "min", "minimise": "min", "maximize": "max", "maximise": "max"}
# Words of pymoo, Optuna and scikit-optimize.
_ELSEWHERE = {"n_obj": "objectives", "n_ieq_constr": "constraints", "n_var": "lower and upper", "xl": "lower",
              "xu": "upper", "pop_size": "population", "n_trials": "evaluations", "n_calls": "evaluations",
              "max_evals": "evaluations", "directions": "senses", "random_state": "seed", "n_initial_points": "initial",
              "batch_size": "ask(n), and how many may be under way is ahead"}
_FAULTS_OF_THE_CODE = (NameError, ImportError, SyntaxError)


class Designs(np.ndarray[Any, np.dtype[np.float64]]):
    """Designs that `Search.ask` gives: an array (n, variables) whose rows have ids.

    Rows that are selected, reordered, rounded or converted to another type keep their ids. np.asarray(X) has none.

    Attributes
    ----------
    ids : numpy.ndarray of int or None
        (n,) ids by which `Search.tell` knows the rows.
    """

    ids: npt.NDArray[np.int64] | None
    _of: object

    def __array_finalize__(self, parent: object) -> None:
        self.ids, self._of = None, None

    def _named(self, ids: npt.NDArray[np.int64] | None, of: object) -> Designs:
        if ids is not None and self.ndim == 2 and ids.shape == self.shape[:1]:
            self.ids, self._of = ids, of
        return self

    def __getitem__(self, key: Any) -> Any:
        part = super().__getitem__(key)
        if isinstance(part, Designs) and part.ndim == 2 and self.ids is not None:
            part._named(self.ids[key[:1] if isinstance(key, tuple) else key], self._of)
        return part

    def __array_wrap__(self, array: Any, context: Any = None) -> Any:
        return array.view(Designs)._named(self.ids, self._of) if array.ndim == 2 else array[()]

    def round(self, *arguments: Any, **more: Any) -> Any:
        """Like numpy.ndarray.round; rows keep their ids, as they do in arithmetic."""
        return self.__array_wrap__(super().round(*arguments, **more))

    def astype(self, *arguments: Any, **more: Any) -> Any:
        """Like numpy.ndarray.astype; rows keep their ids."""
        return self.__array_wrap__(super().astype(*arguments, **more))

    def to_frame(self) -> Any:
        """A pandas.DataFrame of columns x1, x2, ..., indexed by id, which `Search.tell` takes as well."""
        return frame({f"x{j + 1}": column for j, column in enumerate(np.asarray(self).T)}, self.ids)


class Search(library.Handle, Tabular):
    """A search for the Pareto front of your function by few evaluations.

    Parameters
    ----------
    lower, upper : array_like
        (variables,) bounds.
    objectives : int
        Number of values that the function returns.
    kinds : str or list of str, optional
        "real", "log", "int", "list:4|5|8", "choice:steel|oak", one for all variables or of each. A choice is 0, 1, ... in X.
    seed : int or None
        None draws one and keeps it in `seed`. The same arguments, answers and seed give the same designs, bit by bit.
    evaluations : int
        Largest number of designs to evaluate.
    constraints : int
        Number of further values g that the function returns; a design is feasible where all g <= 0.
    senses : str or list of str, optional
        "min" or "max", also "minimize" or "maximize", one for all objectives or one of each.
    start : array_like, optional
        (n, variables) initial designs.
    **settings
        Settings of [search] as `imtet settings search` lists them: population=40, stop_after=300, ahead=32 (designs
        that may be under way at once, the largest batch), aspire="f1 0.5,f2 3" (objectives are f1, f2, ...).

    Attributes
    ----------
    variables, objectives, constraints : int
    seed : int or None
        None if the search was loaded from a file.
    """

    _instead = "save it, and imtet.Search.load the file wherever it is wanted again"

    def __init__(self, lower: npt.ArrayLike, upper: npt.ArrayLike, objectives: int = 0,
                 kinds: str | Sequence[str] | None = None, seed: int | None = 1, evaluations: int = 500,
                 constraints: int = 0, senses: str | Sequence[str] | None = None, start: npt.ArrayLike | None = None,
                 **settings: object) -> None:
        for word in _ELSEWHERE.keys() & settings.keys():
            raise TypeError(f"Search takes no {word}; here it is {_ELSEWHERE[word]}")
        low, high = (np.ascontiguousarray(bound, dtype=np.float64).ravel() for bound in (lower, upper))
        if low.size != high.size:
            raise ValueError(f"lower has {low.size} numbers, upper {high.size}")
        for what, number in (("objectives", objectives), ("constraints", constraints)):
            if not isinstance(number, (int, np.integer)) or number < (what == "objectives"):
                raise ValueError(f"{what} is {number!r}, wanted a whole number of {int(what == 'objectives')} or more")
        given = None if start is None else library.matrix("start", start, low.size)
        if isinstance(senses, str):
            senses = senses.split(",")
        self.seed: int | None = secrets.randbits(31) if seed is None else seed
        words = library.word_list(library.assignments("search", {"seed": self.seed, "max_evals": evaluations, **settings}))
        options = library.Options(
            ctypes.sizeof(library.Options), low.size, objectives, constraints, pointer(low), pointer(high),
            library.one_text(kinds), library.one_text(senses and [_SENSES.get(s.strip(), s) for s in senses]),
            0 if given is None else len(given), pointer(given), words)
        self._search = library.handle()
        call("imtet_search_create", ctypes.byref(options), ctypes.byref(self._search))
        self._open()

    def _open(self) -> None:
        state = self._look()
        self.variables: int = state.variables
        self.objectives: int = state.objectives
        self.constraints: int = state.constraints
        low, high = (np.ctypeslib.as_array(bound, (self.variables,)) for bound in (state.lower, state.upper))
        self._width = np.where(high > low, high - low, 1.0)
        senses = state.senses.decode().split(",")
        self._signs = [-1.0 if word.strip() == "max" else 1.0 for word in senses * (self.objectives // len(senses))]
        self._under_way: dict[int, Array] = {}  # id to design: asked of the library and not told
        self._to_give: list[int] = []  # those of them that `ask` gives first
        self._fetched: tuple[Any, Array, Any] | None = None  # answer of the library that is not entered yet
        self._finished: dict[int, tuple[object, Any]] = {}  # results of `evaluate` for designs under way
        self._is_telling = False
        self._changed = threading.Condition()

    @classmethod
    def load(cls, path: Path) -> Search:
        """Load a search from the file that `save` wrote.

        `ask` gives the designs under way again. On a processor whose linear algebra differs in the last bits the search
        continues with other designs, and a RuntimeWarning says so.
        """
        self = cls.__new__(cls)
        self._search, self.seed = library.handle(), None
        call("imtet_search_load", os.fsencode(path), ctypes.byref(self._search))
        self._open()
        return self

    def save(self, path: Path) -> None:
        """Save the search to a file.

        A kill loses nothing: a whole new file replaces the old one, which is kept as PATH.prev.
        """
        call("imtet_search_save", self._search, os.fsencode(path))

    def __del__(self) -> None:
        if getattr(self, "_search", None):
            library.lib.imtet_search_free(ctypes.byref(self._search))

    def __repr__(self) -> str:
        s = self.state
        return (f"<imtet.Search: {self.variables} variables, {self.objectives} objectives, {s['told']} designs told, "
                f"{s['failed']} of them failed, {s['under_way']} under way, {s['left']} left"
                + (f"; done: {s['why']}>" if s["done"] else ">"))

    def _look(self) -> State:
        state = State(ctypes.sizeof(State))
        call("imtet_search_look", self._search, ctypes.byref(state))
        return state

    @property
    def done(self) -> bool:
        """True when the search asks for nothing more."""
        return bool(self._look().done)

    @property
    def ask_ready(self) -> bool:
        """True when `ask` can give a design now, without another answer."""
        with self._changed:
            self._recover()
            return bool(self._to_give or self._look().ready)

    @property
    def state(self) -> dict[str, Any]:
        """Counts of designs told, failed, under_way (asked for and not told) and left (of evaluations); done, and why."""
        s = self._look()
        return {"told": s.told, "failed": s.failed, "under_way": s.under_way, "left": s.left, "done": bool(s.done),
                "why": s.why.decode()}

    @property
    def under_way(self) -> Designs:
        """Designs that were asked for and not told, in the order of asking."""
        with self._changed:
            self._recover()
            return self._designs_of([i for i in self._under_way if i not in self._to_give])

    def _designs_of(self, ids: list[int]) -> Designs:
        X = np.array([self._under_way[i] for i in ids]).reshape(len(ids), self.variables)
        return X.view(Designs)._named(np.array(ids, dtype=np.int64), self._under_way)

    def _recover(self) -> None:
        """Enter what the library gave and what it was told; after Ctrl-C the next call does it."""
        if self._is_telling:
            self._forget(self._designs(1)[0])
        if self._fetched is not None:
            ids, X, found = self._fetched
            for i, x in zip(ids[:found.value], X):
                self._under_way.setdefault(i, x.copy())
                if i not in self._to_give:
                    self._to_give.append(i)
            self._fetched = None

    def _forget(self, told: Iterable[int]) -> None:
        for i in told:
            self._under_way.pop(i, None)
            self._finished.pop(i, None)
        self._to_give = [i for i in self._to_give if i in self._under_way]
        self._is_telling = False

    def ask(self, n: int = 1, wait: bool = False) -> Designs:
        """Give designs to evaluate.

        Parameters
        ----------
        n : int
            Largest number of designs, a batch; `ahead` limits how many may be under way.
        wait : bool
            If no design can be chosen before others are told, wait until another thread tells one.

        Returns
        -------
        Designs
            X (m, variables) with `ids`, m <= n; m is 0 only when the search is done.

        Raises
        ------
        ImtetError
            If no design can be chosen before others are told and `wait` is False. `ask_ready` says so beforehand.
        """
        if not isinstance(n, (int, np.integer)) or n < 0:
            raise ValueError(f"n is {n!r}, wanted an int: how many designs")
        n = min(int(n), 1 << 20)
        with self._changed:
            while True:
                self._recover()
                wanted = n - len(self._to_give)
                if wanted > 0:
                    found, ids = library.size(), (ctypes.c_long * wanted)()
                    X = np.empty((wanted, self.variables))
                    self._fetched = ids, X, found
                    call("imtet_search_ask", self._search, wanted, ids, pointer(X), ctypes.byref(found))
                    self._recover()
                if self._to_give or n == 0 or self.done:
                    break
                if not wait:
                    raise ImtetError(1, f"no design can be chosen before one of the {len(self._under_way)} under way is "
                                     "told: tell those (search.under_way has them), ask only while search.ask_ready, or "
                                     "wait for other threads by ask(n, wait=True)")
                self._changed.wait()
            X = self._designs_of(self._to_give[:n])
            del self._to_give[:n]
            return X

    def _names(self, letter: str, n: int) -> list[str]:
        return [f"{letter}{k + 1}" for k in range(n)]

    def _ids(self, X: Array, carried: Sequence[int] | None) -> list[int]:
        """Ids of the rows of X: those they carry, else that of the nearest design under way within 1e-6 of the box."""
        under_way = self._under_way
        found: list[int] = []
        known = np.array(list(under_way))
        where = np.array(list(under_way.values())).reshape(-1, self.variables)
        free = np.ones(len(known), dtype=bool)
        for i, x in enumerate(X):
            own = None if carried is None else int(carried[i])
            apart = np.where(free[:, None], abs(where - x) / self._width, np.inf).max(axis=1, initial=0)
            if own in under_way and apart[known == own][0] <= _CLOSE:
                near = int(np.flatnonzero(known == own)[0])
            else:
                near = int(apart.argmin()) if len(known) else -1
            if near >= 0 and apart[near] <= _CLOSE:
                own = int(known[near])
            if own is None:
                raise ValueError(f"row {i} of X was not asked for, or is told already: " + (
                    f"the nearest design under way, {known[near]}, is {apart[near]:.2g} of the box away (1e-6 is "
                    "allowed); tell the array that ask gave, whose rows have ids" if near >= 0 and apart[near] < np.inf
                    else "no other design is under way"))
            free[known == own] = False
            found.append(own)
        return found

    def tell(self, X: Any, Y: Any, G: Any = None, ids: Sequence[int] | None = None) -> None:
        """Tell the results of designs. The whole call is refused if a shape is wrong or a number is not finite.

        Parameters
        ----------
        X : Designs, pandas.DataFrame or array_like
            (n, variables) in any order. Rows of `ask` and of `Designs.to_frame` are known by their ids, also rounded or as
            float32; other rows by the nearest design under way within 1e-6 of the box, of equal designs the oldest.
        Y : sequence
            n rows of `objectives` numbers. None or an exception in place of a row says that the design failed. With
            constraints a row may be a pair (f, g).
        G : array_like, optional
            (n, constraints), if rows of Y are no pairs.
        ids : sequence of int, optional
            (n,) ids of the rows, if X has lost them.
        """
        names = self._names("x", self.variables)
        carried: Any = ids
        if ids is None and isinstance(X, Designs) and X._of is self._under_way:
            carried = X.ids
        if hasattr(X, "columns") and set(names) <= set(X.columns):
            if ids is None and X.index.name == "id":
                carried = X.index
            X = X[names]
        X = library.matrix("X", X, self.variables)
        if carried is not None and len(carried) != len(X):
            raise ValueError(f"X has {len(X)} rows, ids {len(carried)}")
        Y = library.rows("Y", Y, len(X), self.objectives)
        G = None if G is None else library.rows("G", G, len(X), self.constraints)
        F, H = np.zeros((len(X), self.objectives)), np.zeros((len(X), self.constraints))
        failed = (ctypes.c_char_p * max(len(X), 1))()
        for i, y in enumerate(Y):
            if y is None or isinstance(y, BaseException):
                failed[i] = _reason(y).encode(errors="replace")
                continue
            if self.constraints > 0 and G is None and not self._is_pair(y):
                raise ValueError(f"row {i} of Y is no tuple (f, g), and there is no G of shape ({len(X)}, {self.constraints})")
            f, g = y if self._is_pair(y) else (y, G[i] if G is not None else ())
            F[i] = library.row(f"row {i} of Y", f, self.objectives)
            H[i] = library.row(f"row {i} of G", g, self.constraints)
        with self._changed:
            self._recover()
            told = self._ids(X, carried)
            self._is_telling = True
            call("imtet_search_tell", self._search, len(X), (ctypes.c_long * max(len(X), 1))(*told), pointer(F), pointer(H),
                 failed)
            self._forget(told)
            self._changed.notify_all()

    def _is_pair(self, y: Any) -> bool:
        return (self.constraints > 0 and isinstance(y, tuple) and len(y) == 2
                and (self.objectives == 1 or np.ndim(y[0]) == 1))

    def evaluate(self, f: Callable[[Array], Any], X: npt.ArrayLike, threads: int = 1,
                 catch: Catch = Exception) -> list[Any]:
        """[f(x) for x in X], for `tell`.

        A design fails if f raises an exception of `catch`, or returns None or a number that is not finite. If anything
        else ends the call, such as Ctrl-C, no finished evaluation is lost: `ask` gives these designs again, and
        `evaluate` with the same f calls it only for the unfinished ones.

        Parameters
        ----------
        f : callable
            f(x) of one design x (variables,) returns `objectives` numbers, with constraints a pair (f, g).
        X : Designs or array_like
            (n, variables).
        threads : int
            Calls at a time. More are faster if f releases the GIL, for instance while it waits for a program.
        catch : exception or tuple of exceptions
            Exceptions that fail a design; all others are raised. The default also raises NameError, ImportError and
            SyntaxError: they are faults of the code, not of a design.

        Returns
        -------
        list
            For each row what f returned, or the exception.
        """
        rows = np.array(X, dtype=np.float64, ndmin=2)
        ids: Any = X.ids if isinstance(X, Designs) and X._of is self._under_way and X.ids is not None else [0] * len(rows)

        def answer(i: int, x: Array) -> Any:
            known: Any = self._finished.get(i)
            if known and known[0] == f:
                return known[1]
            try:
                y = f(x)
                if y is not None:
                    parts = y if self._is_pair(y) else (y,)
                    if not all(np.isfinite(np.asarray(part, dtype=np.float64)).all() for part in parts):
                        y = ArithmeticError("the answer is not finite")
            except catch as fault:
                if catch is Exception and isinstance(fault, _FAULTS_OF_THE_CODE):
                    raise
                y = fault
            if i:
                self._finished[i] = f, y
            return y

        pool = concurrent.futures.ThreadPoolExecutor(threads) if threads > 1 else None
        try:
            work: Any = pool.map if pool else map
            return list(work(answer, map(int, ids), rows))
        except BaseException:
            with self._changed:
                again = [int(i) for i in ids if i in self._under_way and i not in self._to_give]
                self._to_give[:0] = again
            raise
        finally:
            if pool:
                pool.shutdown(cancel_futures=True)

    def run(self, f: Callable[[Array], Any], batch: int = 8, threads: int = 1,
            catch: Catch = Exception,
            callback: Callable[[Search], object] | None = None) -> tuple[Array, Array]:
        """Ask, evaluate and tell until the search is done.

        Parameters
        ----------
        f, threads, catch
            As for `evaluate`.
        batch : int
            Largest number of designs asked for at a time.
        callback : callable, optional
            Called with the search after every batch; the loop ends if it returns True.

        Returns
        -------
        F, X : numpy.ndarray
            As `front`.
        """
        while not self.done:
            X = self.ask(batch)
            self.tell(X, self.evaluate(f, X, threads, catch))
            if callback and callback(self) is True:
                break
        return self.front()

    def _designs(self, which: int) -> tuple[npt.NDArray[np.int64], Array, Array, Array]:
        found = library.size()
        call("imtet_search_designs", self._search, which, 0, None, None, None, None, ctypes.byref(found))
        n = found.value
        ids, X = np.empty(n, dtype=np.int64), np.empty((n, self.variables))
        F, G = np.empty((n, self.objectives)), np.empty((n, self.constraints))
        call("imtet_search_designs", self._search, which, n, ids.ctypes.data_as(ctypes.POINTER(ctypes.c_long)), pointer(X),
             pointer(F), pointer(G), ctypes.byref(found))
        return ids, X, F, G

    def front(self, order: str = "FX") -> tuple[Array, Array]:
        """The feasible designs that no other one dominates.

        Parameters
        ----------
        order : {"FX", "XF"}
            What comes first.

        Returns
        -------
        F, X : numpy.ndarray
            (n, objectives) and (n, variables): values before designs, unless `order` says otherwise.
        """
        if order not in ("FX", "XF"):
            raise ValueError(f"order is {order!r}, wanted FX or XF")
        _, X, F, _ = self._designs(0)
        return (F, X) if order == "FX" else (X, F)

    def told(self) -> tuple[Array, Array, Array]:
        """F, X and G of all designs told, in the order of asking; F and G are NaN where a design failed."""
        _, X, F, G = self._designs(1)
        return F, X, G

    def _table(self) -> Any:
        ids, X, F, G = self._designs(1)
        on_front = np.isin(ids, self._designs(0)[0])
        is_fit = np.isfinite(F).all(axis=1) & (G <= 0).all(axis=1)
        columns = {name: column for letter, array in (("x", X), ("f", F), ("g", G))
                   for name, column in zip(self._names(letter, array.shape[1]), array.T)}
        return columns, ids, self._names("f", self.objectives), self._signs, on_front, is_fit


def _reason(fault: BaseException | None) -> str:
    return "None was answered" if fault is None else f"{type(fault).__name__}: {fault}"
