"""Problems and algorithms in the form of pymoo: a problem object (n_var, n_obj, n_ieq_constr, xl, xu, _evaluate(X, out))
searched by imtet, and imtet as an algorithm object with setup, has_next, ask, tell and result.

pymoo is not in Debian, and need not be installed: only the form is used. A problem of pymoo's own classes will do as well;
the algorithm does not go into pymoo.optimize.minimize, whose populations are pymoo's own.
"""
from __future__ import annotations

from typing import Any, Optional, Protocol

import numpy as np
import numpy.typing as npt

import imtet

Array = npt.NDArray[np.float64]


class Problem(Protocol):
    n_var: int
    n_obj: int
    n_ieq_constr: int
    xl: Array
    xu: Array

    def _evaluate(self, X: Array, out: dict[str, Any]) -> None: ...


class BinhKorn:
    """Binh and Korn, MOBES (1997): two objectives, two constraints g <= 0."""
    n_var, n_obj, n_ieq_constr = 2, 2, 2
    xl, xu = np.array([0.0, 0.0]), np.array([5.0, 3.0])

    def _evaluate(self, X: Array, out: dict[str, Any]) -> None:
        a, b = X[:, 0], X[:, 1]
        out["F"] = np.column_stack([4 * a ** 2 + 4 * b ** 2, (a - 5) ** 2 + (b - 5) ** 2])
        out["G"] = np.column_stack([(a - 5) ** 2 + b ** 2 - 25, 7.7 - (a - 8) ** 2 - (b + 3) ** 2])


class Algorithm:
    """As pymoo's algorithms by ask and tell; batch stands for pop_size."""

    def __init__(self, batch: int = 8, evaluations: int = 200, **settings: Any) -> None:
        self.batch = batch
        self.settings: dict[str, Any] = {"evaluations": evaluations, **settings}

    def setup(self, problem: Problem, seed: Optional[int] = 1) -> Algorithm:
        self.problem = problem
        self.search = imtet.Search(problem.xl, problem.xu, problem.n_obj, constraints=problem.n_ieq_constr, seed=seed,
                                   **self.settings)
        return self

    def has_next(self) -> bool:
        return not self.search.done

    def ask(self) -> imtet.Designs:
        return self.search.ask(self.batch)

    def tell(self, X: imtet.Designs, out: dict[str, Any]) -> None:
        self.search.tell(X, out["F"], G=out["G"] if self.problem.n_ieq_constr else None)

    def result(self) -> tuple[Array, Array]:
        """F, X: values before designs."""
        return self.search.front()


if __name__ == "__main__":
    algorithm = Algorithm().setup(BinhKorn())
    while algorithm.has_next():
        X = algorithm.ask()
        out: dict[str, Any] = {}
        algorithm.problem._evaluate(X, out)
        algorithm.tell(X, out)
    F, X_front = algorithm.result()
    print(f"{len(F)} designs, f1 {F[:, 0].min():.1f} to {F[:, 0].max():.1f}, f2 {F[:, 1].min():.1f} to {F[:, 1].max():.1f}")
