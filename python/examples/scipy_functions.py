"""Functions and bounds in the form of scipy.optimize: minimize(f, bounds, args), one objective or several."""
from __future__ import annotations

from typing import Any, Callable, Sequence

import numpy as np
import numpy.typing as npt

import imtet

Array = npt.NDArray[np.float64]


def minimize(functions: Sequence[Callable[..., float]], bounds: Sequence[tuple[float, float]], args: tuple[Any, ...] = (),
             evaluations: int = 150, **settings: Any) -> tuple[Array, Array]:
    """Front of functions: F (n, functions), X (n, variables), values before designs. bounds: pairs (lower, upper)."""
    lower, upper = zip(*bounds)
    search = imtet.Search(lower, upper, len(functions), evaluations=evaluations, **settings)
    return search.run(lambda x: [f(x, *args) for f in functions])


def rosenbrock(x: Array) -> float:
    return float(sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))


def distance(x: Array) -> float:
    return float(np.linalg.norm(x))


if __name__ == "__main__":
    F, X = minimize([rosenbrock], [(-2, 2)] * 2)
    print(f"least Rosenbrock {F[0, 0]:.2g} at {X[0].round(3)}, wanted 0 at [1 1]")
    F, X = minimize([rosenbrock, distance], [(-2, 2)] * 2)
    print(f"{len(F)} trade-offs between Rosenbrock and the distance from 0")
