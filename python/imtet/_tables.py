"""Tables and pictures that a search and a run have in common: frames of pandas, plots of matplotlib."""
from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import numpy.typing as npt

from ._library import Array


def module(name: str, package: str, what: str) -> Any:
    """Import an optional module, or raise ImportError with the package that has it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"{what} needs {name.split('.')[0]}: apt-get install {package}") from None


def frame(columns: dict[str, Any], ids: Any) -> Any:
    pandas = module("pandas", "python3-pandas", "to_frame")
    return pandas.DataFrame(columns, index=pandas.Index(ids, name="id"))


def growth(F: Array, front: npt.NDArray[np.bool_]) -> Array:
    """Hypervolume after each design, as a share of the box of the front: by 4,096 points, so that 1 % is its error."""
    F_front = F[front]
    low, high = F_front.min(axis=0), F_front.max(axis=0)
    points = low + (high - low) * np.random.default_rng(1).random((4096, F.shape[1]))
    won, share = np.zeros(len(points), dtype=bool), np.zeros(len(F))
    for i, f in enumerate(F):
        won |= (f <= points).all(axis=1)
        share[i] = won.mean()
    return share


class Tabular:
    """Needs _table: columns by name, ids, names of the objectives, signs (-1: larger is better), which designs are on the
    front, which succeeded and keep their constraints."""

    def _table(self) -> Any:
        raise NotImplementedError

    def to_frame(self, front: bool = False) -> Any:
        """Designs as a pandas.DataFrame.

        Parameters
        ----------
        front : bool
            Only the designs on the front.

        Returns
        -------
        pandas.DataFrame
            One row per design, indexed by id: variables, objectives, other results.
        """
        columns, ids, _, _, on_front, _ = self._table()
        chosen = on_front if front else np.ones(len(ids), dtype=bool)
        return frame({name: values[chosen] for name, values in columns.items()}, ids[chosen])

    def plot(self, kind: str = "pairs") -> Any:
        """A picture of the objectives.

        Parameters
        ----------
        kind : {"pairs", "parallel", "history"}
            Every objective against every other one; designs of the front as lines over parallel axes; the front's
            hypervolume over the designs, as a share of its box.

        Returns
        -------
        matplotlib.figure.Figure
            `savefig` writes it; a notebook shows it.
        """
        plt = module("matplotlib.pyplot", "python3-matplotlib", "plot")
        columns, ids, names, signs, front, is_fit = self._table()
        F = np.column_stack([columns[name] for name in names])
        n = len(names)
        if kind not in ("pairs", "parallel", "history"):
            raise ValueError(f"kind is {kind!r}, wanted pairs, parallel or history")
        if not front.any():
            raise ValueError("no design is on the front yet: there is nothing to be drawn")
        if kind == "pairs":
            figure, axes = plt.subplots(n, n, squeeze=False, figsize=(2 * n + 2, 2 * n + 2))
            for i, j in np.ndindex(n, n):
                if i == j:
                    axes[i, i].hist(F[front, i], color="tab:blue")
                else:
                    axes[i, j].scatter(F[:, j], F[:, i], s=4, color="lightgrey")
                    axes[i, j].scatter(F[front, j], F[front, i], s=8, color="tab:blue")
                axes[i, j].set(xlabel=names[j] if i == n - 1 else "", ylabel=names[i] if j == 0 else "")
            return figure
        figure, axis = plt.subplots(figsize=(8, 4))
        if kind == "history":
            axis.step(np.arange(1, len(ids) + 1), growth(np.where(is_fit[:, None], F * signs, np.inf), front), where="post")
            axis.set(xlabel="designs", ylabel="hypervolume of the front's box", ylim=(0, None))
            return figure
        low, high = F[front].min(axis=0), F[front].max(axis=0)
        axis.plot(((F[front] - low) / np.where(high > low, high - low, 1)).T, color="tab:blue", alpha=0.3)
        axis.set_xticks(range(n), [f"{name}\n{a:.3g} to {b:.3g}" for name, a, b in zip(names, low, high)])
        axis.set_yticks([])
        return figure
