"""Functions and bounds in the form of scipy.optimize: minimize(f, bounds, args), one objective or several."""
import imtet


def minimize(functions, bounds, args=(), evaluations=150, **settings):
    """Front of one function or a list of them: F (n, functions), X (n, variables). bounds: pairs (lower, upper)."""
    functions = list(functions) if isinstance(functions, (list, tuple)) else [functions]
    lower, upper = zip(*bounds)
    search = imtet.Search(lower, upper, len(functions), evaluations=evaluations, **settings)
    while not search.done:
        X = search.ask(8)
        search.tell(X, search.evaluate(lambda x: [f(x, *args) for f in functions], X))
    return search.front()


def rosenbrock(x):
    return sum(100 * (b - a * a) ** 2 + (1 - a) ** 2 for a, b in zip(x[:-1], x[1:]))


def distance(x):
    return sum(v * v for v in x) ** 0.5


if __name__ == "__main__":
    F, X = minimize(rosenbrock, [(-2, 2)] * 2)
    print(f"least Rosenbrock {F[0, 0]:.2g} at {X[0].round(3)}, wanted 0 at [1 1]")
    F, X = minimize([rosenbrock, distance], [(-2, 2)] * 2)
    print(f"{len(F)} trade-offs between Rosenbrock and the distance from 0")
