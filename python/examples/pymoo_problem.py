"""A problem object in the form of pymoo (n_var, n_obj, n_ieq_constr, xl, xu, _evaluate(X, out)), searched by imtet.

pymoo need not be installed: only the form is used. An object of pymoo's own classes will do as well.
"""
import numpy as np

import imtet


class BinhKorn:
    """Binh and Korn, MOBES (1997): two objectives, two constraints g <= 0."""
    n_var, n_obj, n_ieq_constr = 2, 2, 2
    xl, xu = np.array([0.0, 0.0]), np.array([5.0, 3.0])

    def _evaluate(self, X, out):
        a, b = X[:, 0], X[:, 1]
        out["F"] = np.column_stack([4 * a ** 2 + 4 * b ** 2, (a - 5) ** 2 + (b - 5) ** 2])
        out["G"] = np.column_stack([(a - 5) ** 2 + b ** 2 - 25, 7.7 - (a - 8) ** 2 - (b + 3) ** 2])


def minimize(problem, evaluations=200, batch=8, **settings):
    """F (n, n_obj), X (n, n_var) of the front."""
    search = imtet.Search(problem.xl, problem.xu, problem.n_obj, constraints=problem.n_ieq_constr, evaluations=evaluations,
                          **settings)
    while not search.done:
        X, out = search.ask(batch), {}
        problem._evaluate(X, out)
        search.tell(X, out["F"], G=out["G"] if problem.n_ieq_constr else None)
    return search.front()


if __name__ == "__main__":
    F, X = minimize(BinhKorn())
    print(f"{len(F)} designs, f1 {F[:, 0].min():.1f} to {F[:, 0].max():.1f}, f2 {F[:, 1].min():.1f} to {F[:, 1].max():.1f}")
