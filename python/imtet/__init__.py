"""imtet: Pareto fronts by few evaluations, and the simulation of towers that collide with a core.

The package calls libimtet.so by ctypes and needs numpy alone; pandas and matplotlib are used where they are installed.
Arrays are float64. Rows of X are designs, rows of F their objectives in natural signs and units. The library's errors are
`ImtetError`: a sentence that says what to do. Calls release the GIL, so that threads may simulate side by side. Ctrl-C
ends a call as soon as the library returns (milliseconds; choosing designs takes some 10 ms to seconds).

    import imtet
    search = imtet.Search(lower=[0] * 6, upper=[1] * 6, objectives=2, evaluations=200)
    while not search.done:
        X = search.ask(8)
        search.tell(X, search.evaluate(f, X))     # f(x) -> two numbers; an exception or None: the design failed
    F, X = search.front()                         # F before X
"""
from ._library import ImtetError, __version__
from ._runs import Run, merge_fronts, open_run
from ._scene import Result, Scene, read_motion
from ._search import Designs, Search

version = __version__

__all__ = ["Search", "Designs", "Scene", "Result", "Run", "open_run", "merge_fronts", "read_motion", "version",
           "ImtetError", "__version__"]
