"""python/imtet against the program and against itself. test_imtet.py FOLDER: where its files go; $IMTET is the program."""
import copy
import ctypes
import importlib.util
import json
import math
import os
import pathlib
import pickle
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import threading
import time
import unittest

os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")  # the bytes of the program on every processor
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "python"))
import numpy as np  # noqa: E402
import imtet  # noqa: E402
from imtet import _library as library  # noqa: E402

PLACE, PROGRAM = os.path.abspath(sys.argv.pop(1)), os.environ["IMTET"]
SETTINGS = {"initial": 16, "population": 12, "threads": 1}
SIX = {"building.model": os.path.join(ROOT, "configs/neighbours/tower"), "core.width_m": 5, "design.gap_m": "0.001,0.05",
       "motion.pga_g": 0.3}
SHORT = [w for k, v in {**SIX, "motion.record": "builtin:elcentro-like", "sim.duration_s": 8}.items() for w in ("--set", f"{k}={v}")]

NEEDS_PANDAS, NEEDS_MATPLOTLIB = (unittest.skipUnless(importlib.util.find_spec(name), f"{name} (python3-{name}) is not here")
                                  for name in ("pandas", "matplotlib"))


def f(x):
    if 0.30 < x[0] < 0.42:
        raise RuntimeError("does not converge")
    return [x[0], (1 - math.sqrt(x[0])) + sum((v - 0.5) ** 2 for v in x[1:])]


def search(**more):
    return imtet.Search([0] * 4, [1] * 4, 2, evaluations=60, **{**SETTINGS, **more})


def drive(s, n=8, after=None):
    while not s.done:
        X = s.ask(n)
        s.tell(X, s.evaluate(f, X))
        if after:
            after(s)
    return s


DRIVER = """
import os, sys
sys.argv = [sys.argv[0], {place!r}, *sys.argv[1:]]
sys.path.insert(0, {here!r})
from test_imtet import *
state = sys.argv[1]
s = imtet.Search.load(state) if os.path.exists(state) else search()
drive(s, 3, lambda s: s.save(state))
np.save(state + ".npy", np.hstack(s.told()[:2]))
"""


def driver():
    name = os.path.join(PLACE, "driver.py")
    pathlib.Path(name).write_text(DRIVER.format(place=PLACE, here=os.path.dirname(os.path.abspath(__file__))))
    return name


def program(*words):
    return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True, cwd=ROOT).stdout


class Searching(unittest.TestCase):
    def test_designs_are_those_of_optimize_with_the_same_function_as_a_worker(self):
        worker = os.path.join(PLACE, "worker.py")
        pathlib.Path(worker).write_text(
            "import json, math, sys\nfor line in sys.stdin:\n    r = json.loads(line)\n    x = r['x']\n"
            "    a = {'f': [x[0], (1 - math.sqrt(x[0])) + sum((v - 0.5) ** 2 for v in x[1:])]}\n"
            "    print(json.dumps({'id': r['id'], **({'error': 'no'} if 0.30 < x[0] < 0.42 else a)}), flush=True)\n")
        pathlib.Path(PLACE, "w.ini").write_text(
            f"[problem]\nkind = external\ncommand = python3 {worker}\nvariables = 4\nobjectives = 2\n[search]\n"
            "initial = 16\npopulation = 12\nmax_evals = 60\nthreads = 1\n")
        program("optimize", os.path.join(PLACE, "w.ini"), "--out", os.path.join(PLACE, "w"))
        run = imtet.open_run(os.path.join(PLACE, "w"))
        F, X, _ = drive(search()).told()
        for j in range(4):
            np.testing.assert_array_equal(X[:, j], run.designs[f"x{j + 1}"])
        for k in range(2):
            np.testing.assert_array_equal(F[:, k], run.designs[f"f{k + 1}"])
        self.assertTrue(np.isnan(F).any())
        front, where = drive(search()).front()
        np.testing.assert_array_equal(front[:, 1], run.front.f2)
        self.assertEqual(where.shape, (len(run.front), 4))

    def test_designs_are_asked_for_in_whole_numbers(self):
        for n in (1.5, -1, "2", math.nan):
            self.assertRaisesRegex(ValueError, f"n is {n!r}, wanted an int: how many designs", search().ask, n)
        self.assertEqual(len(search().ask(np.int32(2))), 2)

    def test_f_that_raises_or_says_nothing_fails_its_design_alone(self):
        s = search()
        X = s.ask(4)
        says = {X[0].tobytes(): None, X[1].tobytes(): [1, 2], X[2].tobytes(): [1, math.nan]}
        answers = s.evaluate(lambda x: says[x.tobytes()], X)
        self.assertIsNone(answers[0])
        self.assertEqual(answers[1], [1, 2])
        self.assertIsInstance(answers[2], ArithmeticError)
        self.assertIsInstance(answers[3], KeyError)
        s.tell(X, answers)
        self.assertEqual(s.state["failed"], 3)

    def test_rows_may_be_told_in_any_order_and_constraints_as_pairs_or_as_G(self):
        a, b = (imtet.Search([0] * 3, [1] * 3, 2, constraints=1, evaluations=60, **SETTINGS) for _ in "ab")
        while not a.done:
            X, Y = a.ask(5), b.ask(5)
            np.testing.assert_array_equal(X, Y)
            F, G = np.column_stack([X[:, 0], 1 - X[:, 0] * X[:, 1]]), X[:, 2:] - 0.5
            a.tell(X, F, G=G)
            order = np.random.default_rng(len(X)).permutation(len(X))
            b.tell(X[order], [(F[i], G[i]) for i in order])
        self.assertTrue(b.done)
        for left, right in zip(a.told(), b.told()):
            np.testing.assert_array_equal(left, right)
        F, X = a.front()
        self.assertTrue((X[:, 2] <= 0.5).all() and len(F) > 3)

    def test_what_makes_no_sense_is_said_so(self):
        s = search()
        X = s.ask(3)
        self.assertRaisesRegex(ValueError, r"X has shape \(3, 2\), wanted \(n, 4\)", s.tell, X[:, :2], np.ones((3, 2)))
        for Y, words in ((np.ones((2, 2)), r"X has 3 rows, Y 2: wanted shape \(3, 2\)"),
                         (np.ones((3, 3)), r"row 0 of Y has shape \(3,\), wanted \(2,\)"),
                         (None, r"Y is None, wanted rows of shape \(3, 2\)"),
                         ([[1, 2], ["a", "b"], [1, 2]], r"row 1 of Y: .*'a'; wanted numbers of shape \(2,\)")):
            self.assertRaisesRegex(ValueError, words, s.tell, X, Y)
        with self.assertRaisesRegex(ValueError, r"row 0 of Y is no tuple \(f, g\), and there is no G of shape \(1, 1\)"):
            bounded = imtet.Search([0] * 3, [1] * 3, 2, constraints=1)
            bounded.tell(bounded.ask(1), [[[1, 2], [3]]])
        with self.assertRaisesRegex(ValueError, r"row 1 of X was not asked for.*nearest design under way, 2, is 2e-06 of the box away"):
            s.tell(np.array([X[0], X[1] + 2e-6, X[2]]), np.ones((3, 2)))
        self.assertRaisesRegex(imtet.ImtetError, "F of design 2: number 1 is nan", s.tell, X, [[1, 2], [math.nan, 2], [1, 2]])
        self.assertRaisesRegex(ValueError, "X: .*wanted numbers of shape", s.tell, [["a", "b"]], [[1, 2]])
        self.assertEqual(s.state["told"], 0)
        s.tell(X, np.ones((3, 2)))
        self.assertRaisesRegex(imtet.ImtetError, "design 1 is told already", s.tell, X, np.ones((3, 2)))
        self.assertRaisesRegex(imtet.ImtetError, "populaton is no setting.*did you mean population", search, populaton=3)
        self.assertRaisesRegex(imtet.ImtetError, "is no saved search", imtet.Search.load, __file__)
        self.assertRaisesRegex(ValueError, "objectives is -1, wanted a whole number of 1 or more", imtet.Search, [0], [1], objectives=-1)
        with self.assertRaisesRegex(imtet.ImtetError, "start: variable 2 of design 1 is 3.5; it is a whole number"):
            imtet.Search([0, 0], [1, 5], 2, kinds="real,int", start=[[0.5, 3.5]])

    def told_as(self, change):
        """Everything a search knows in the end, whose designs are told as `change` of X and the order makes them."""
        s, dice = search(), np.random.default_rng(5)
        while not s.done:
            X = s.ask(7)
            order = dice.permutation(len(X))
            Y = s.evaluate(f, X)
            s.tell(change(X, order), [Y[i] for i in order])
        return np.hstack(s.told()[:2])

    def test_designs_are_known_by_ids_however_they_are_rounded_reordered_or_converted(self):
        wanted = np.hstack(drive(search(), 7).told()[:2])
        for name, change in (("rounded", lambda X, o: np.round(X, 1)[o]), ("float32", lambda X, o: X[o].astype(np.float32).round(2)),
                             ("scaled", lambda X, o: (0.99 * X)[o]), ("plain", lambda X, o: np.asarray(X)[o] + 3e-7),
                             ("taken", lambda X, o: np.take(X, o, axis=0)), ("copied", lambda X, o: copy.deepcopy(X[o])),
                             ("pickled", lambda X, o: pickle.loads(pickle.dumps(X))[o]), ("list", lambda X, o: X[o].tolist())):
            with self.subTest(name):
                np.testing.assert_array_equal(self.told_as(change), wanted)
        s = search()
        X = s.ask(5)
        with self.assertRaisesRegex(ValueError, "row 1 of X was not asked for.*nearest design under way, 2, is 0.0"):
            s.tell(np.asarray(X[:2]) + [[0], [0.004]], [[1, 2]] * 2)
        np.random.default_rng(1).shuffle(X)  # in place: ids stay where they were, and values tell
        s.tell(X, [[x[0], 2] for x in X])
        F, where, _ = s.told()
        np.testing.assert_array_equal(F[:, 0], where[:, 0])
        again = search().ask(5)
        self.assertEqual([list(rows.ids) for rows in (again, again[::2], again[again.ids > 3], again[1:, :2])],
                         [[1, 2, 3, 4, 5], [1, 3, 5], [4, 5], [2, 3, 4, 5]])
        self.assertIsNone(again.T.ids)
        self.assertIsInstance(again.max(), float)
        with self.assertRaisesRegex(ValueError, "no other design is under way"):  # ids of another search say nothing here
            search().tell(again, [[1, 2]] * 5)
        s = search(start=[[0.5] * 4])
        X = s.ask(4)
        s.tell(X.round(9) + 1e-12, [[1, 2]] * 4, ids=X.ids[::-1])
        self.assertEqual(s.state["told"], 4)

    def test_equal_designs_are_told_oldest_first(self):
        s = imtet.Search([1, 1], [1, 2], 2, kinds="int", evaluations=8, initial=4, population=4)
        X = s.ask(2)
        self.assertRaisesRegex(imtet.ImtetError, "design 1 is told twice", s.tell, X[[0, 0]], [[1, 2]] * 2)
        s._under_way[2][:] = s._under_way[1]
        s.tell(np.asarray(s._under_way[1]), [[7, 7]])
        np.testing.assert_array_equal(s.told()[1], X[:1])

    @NEEDS_PANDAS
    def test_tables_of_pandas_are_taken_and_made(self):
        import pandas
        np.testing.assert_array_equal(self.told_as(lambda X, o: X.to_frame().iloc[o].round(1)),
                                      self.told_as(lambda X, o: pandas.DataFrame(np.asarray(X)).iloc[o]))
        s = imtet.Search([0] * 3, [1] * 3, 2, constraints=1, evaluations=60, **SETTINGS)
        while not s.done:
            table = s.ask(5).to_frame().sample(frac=1, random_state=1)
            table["f1"], table["f2"], table["g1"] = table.x1, 1 - table.x1 * table.x2, table.x3 - 0.5
            s.tell(table, table[["f1", "f2"]], G=table[["g1"]])
        whole, front = s.to_frame(), s.to_frame(front=True)
        self.assertEqual((list(whole.columns), len(whole)), (["x1", "x2", "x3", "f1", "f2", "g1"], 60))
        np.testing.assert_array_equal(whole.f1, whole.x1)
        np.testing.assert_array_equal(front[["f1", "f2"]], s.front()[0])
        self.assertTrue((front.g1 <= 0).all())
        np.testing.assert_array_equal(s._table()[-1], whole.g1 <= 0)

    @NEEDS_MATPLOTLIB
    def test_pictures_are_drawn_and_the_history_grows_to_the_area_that_is_dominated(self):
        from imtet._tables import growth
        F = np.array([[3.0, 3.0], [0.0, 1.0], [1.0, 0.0], [0.5, 0.5]])
        share = growth(F, np.array([False, True, True, True]))
        self.assertEqual(list(share[:3]), [0, 0, 0])
        self.assertAlmostEqual(share[3], 0.25, delta=0.03)
        import matplotlib
        matplotlib.use("Agg")
        s = drive(search())
        for kind in ("pairs", "parallel", "history"):
            name = os.path.join(PLACE, kind + ".png")
            s.plot(kind).savefig(name)
            self.assertGreater(os.path.getsize(name), 5000)
        self.assertRaisesRegex(ValueError, "kind is 'pears', wanted pairs, parallel or history", s.plot, "pears")
        self.assertRaisesRegex(ValueError, "nothing to be drawn", search().plot)

    def test_only_what_is_to_be_caught_fails_a_design(self):
        s = search()
        X = s.ask(3)
        self.assertRaises(NameError, s.evaluate, lambda x: nowhere(x), X)  # noqa: F821
        self.assertIsInstance(s.evaluate(lambda x: nowhere(x), X, catch=NameError)[2], NameError)  # noqa: F821
        self.assertRaises(ZeroDivisionError, s.evaluate, lambda x: 1 / 0, X, catch=(OSError, ValueError))
        self.assertIsInstance(s.evaluate(lambda x: 1 / 0, X)[0], ZeroDivisionError)

    def test_ctrl_c_in_a_batch_loses_no_finished_evaluation(self):
        for threads in (1, 3):
            s, called = search(), []

            def slow(x):
                called.append(x.tobytes())
                if len(called) == 6:
                    raise KeyboardInterrupt
                return f(x)
            self.assertRaises(KeyboardInterrupt, s.run, slow, batch=8, threads=threads)
            self.assertEqual((s.state["told"], s.state["under_way"]), (0, 8))
            s.run(slow, batch=8, threads=threads)
            self.assertEqual(len(called), len(set(called)) + 1)  # the one that was interrupted
            np.testing.assert_array_equal(np.hstack(s.told()[:2]), np.hstack(drive(search()).told()[:2]))

    def test_ctrl_c_in_ask_and_tell_loses_no_design(self):
        wanted = np.hstack(drive(search(), 20).told()[:2])

        def interrupted(call, after):
            signal.setitimer(signal.ITIMER_REAL, after)
            try:
                return call()
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
        before = signal.signal(signal.SIGALRM, signal.default_int_handler)
        hits, dice = 0, random.Random(2)
        try:
            for _ in range(int(os.environ.get("PYTHON_INTERRUPTS", 8))):
                s = search()
                while not s.done:
                    try:
                        X = interrupted(lambda: s.ask(20), 10 ** dice.uniform(-5, -2))
                    except KeyboardInterrupt:
                        hits += 1
                        X = s.under_way if not s.ask_ready else s.ask(20)
                    Y = s.evaluate(f, X)
                    try:
                        interrupted(lambda: s.tell(X, Y), 10 ** dice.uniform(-5, -3))
                    except KeyboardInterrupt:
                        hits += 1
                        X = s.under_way
                        s.tell(X, s.evaluate(f, X))
                np.testing.assert_array_equal(np.hstack(s.told()[:2]), wanted)
        finally:
            signal.signal(signal.SIGALRM, before)
        self.assertGreater(hits, 3)

    def test_ask_gives_designs_waits_for_answers_or_says_that_it_cannot(self):
        s = search()
        X = s.ask(100)
        self.assertEqual((len(X), s.ask_ready, len(s.under_way)), (16, False, 16))
        self.assertRaisesRegex(imtet.ImtetError, "before one of the 16 under way is told", s.ask)
        np.testing.assert_array_equal(s.under_way.ids, X.ids)

        def work():
            while not s.done:
                X = s.ask(1, wait=True)
                s.tell(X, s.evaluate(f, X))
        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        s.tell(X, s.evaluate(f, X))
        for thread in threads:
            thread.join()
        self.assertEqual((s.state["told"], len(s.ask(3))), (60, 0))
        np.testing.assert_array_equal(np.hstack(s.told()[:2]), np.hstack(drive(search()).told()[:2]))

    def test_words_of_other_packages_are_taken_or_answered_by_ours(self):
        a = imtet.Search([0, 0], [1, 1], 2, senses=["minimize", "maximize"], seed=None)
        self.assertEqual(a._signs, [1.0, -1.0])
        self.assertNotEqual(a.seed, imtet.Search([0, 0], [1, 1], 2, seed=None).seed)
        b = imtet.Search([0, 0], [1, 1], 2, senses="min,max", seed=a.seed)
        np.testing.assert_array_equal(a.ask(9), b.ask(9))
        for word, ours in (("pop_size", "population"), ("n_obj", "objectives"), ("n_trials", "evaluations")):
            self.assertRaisesRegex(TypeError, f"no {word}; here it is {ours}", imtet.Search, [0, 0], [1, 1], **{word: 2})
        for wrong, said in (({"evaluations": -3}, "^evaluations: -3 is outside"), ({"kinds": "reel"}, "^kinds: 'reel'"),
                            ({"senses": "up"}, "^senses: item 1"), ({"population": 1.5}, "^population: 1.5")):
            self.assertRaisesRegex(imtet.ImtetError, said, imtet.Search, [0, 0], [1, 1], 2, **wrong)

    def test_a_loop_calls_back_and_ends_when_it_is_told_to(self):
        seen = []
        s = search()
        F, X = s.run(f, batch=5, callback=lambda s: seen.append(s.state["told"]) or len(seen) == 4)
        self.assertEqual((len(seen), seen[-1]), (4, s.state["told"]))
        self.assertLess(s.state["told"], 60)
        swapped = s.front(order="XF")
        np.testing.assert_array_equal(swapped[1], F)
        np.testing.assert_array_equal(swapped[0], X)
        self.assertRegex(repr(s), f"^<imtet.Search: 4 variables, 2 objectives, {seen[-1]} designs told, .* left>$")

    def test_a_fork_is_told_to_load_a_saved_search(self):
        s = search()
        s.ask(2)
        child = os.fork()
        if child == 0:
            try:
                s.ask(1)
            except imtet.ImtetError as fault:
                os._exit(7 if "fork" in str(fault) else 1)
            os._exit(1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 7)

    def test_a_search_that_is_saved_goes_on_on_other_kernels_and_says_so_once(self):
        dice, kernels = random.Random(4), ("Haswell", "Sandybridge", "Prescott", "Nehalem")
        path, n = os.path.join(PLACE, "elsewhere.search"), int(os.environ.get("PYTHON_SAVES", 6))
        code = ("import sys; sys.argv = ['', %r]; sys.path.insert(0, %r)\nfrom test_imtet import *\nimport warnings\n"
                "with warnings.catch_warnings(record=True) as said:\n    warnings.simplefilter('always')\n"
                "    s = imtet.Search.load(%r)\n    before = s.told()\n    drive(s)\n"
                "print(len(said), s.state['told'], len(s.front()[0]), all(np.array_equal(a, b[:len(a)], True) for a, b in "
                "zip(before, s.told())), *[w.message for w in said])")
        for i in range(n):
            s = search()
            for _ in range(dice.randrange(12)):
                if s.ask_ready and dice.random() < 0.8:
                    s.ask(dice.randrange(1, 9))
                X = s.under_way[:dice.randrange(9)]
                s.tell(X, s.evaluate(f, X))
            s.save(path)
            other = kernels[i % len(kernels)]
            done = subprocess.run([sys.executable, "-c", code % (PLACE, os.path.dirname(os.path.abspath(__file__)), path)],
                                  env={**os.environ, "OPENBLAS_CORETYPE": other}, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            warned, told, front, kept, *said = done.stdout.split()
            self.assertEqual((told, kept, int(front) > 3), ("60", "True", True))
            self.assertEqual(warned, "0" if other == "Haswell" else "1")
            self.assertTrue(other == "Haswell" or f"for {other} the search goes on" in " ".join(said))

    def test_saves_of_several_processes_are_each_whole_and_the_one_before_is_kept(self):
        path, victim = os.path.join(PLACE, "shared.search"), os.path.join(PLACE, "victim")
        pathlib.Path(victim).write_text("mine")
        s = search()
        for name in (path, path + ".part", f"{path}.{os.getpid()}.tmp"):
            os.symlink(victim, name)
        s.save(path)
        X = s.ask(5)
        s.tell(X, s.evaluate(f, X))
        s.save(path)
        self.assertFalse(os.path.islink(path))
        self.assertEqual(pathlib.Path(victim).read_text(), "mine")
        self.assertEqual([imtet.Search.load(p).state["told"] for p in (path + ".prev", path)], [0, 5])
        s.save(path)  # both tell of five designs before others save
        children = []
        for _ in range(3):
            children.append(os.fork())
            if children[-1] == 0:
                mine = imtet.Search.load(path)
                for _ in range(60):
                    mine.save(path)
                os._exit(0)
        for _ in range(60):
            for name in (path, path + ".prev"):
                self.assertEqual(imtet.Search.load(name).state["told"], 5)
        self.assertEqual([os.waitpid(child, 0)[1] for child in children], [0, 0, 0])
        self.assertEqual(sorted(n for n in os.listdir(PLACE) if n.startswith("shared.search")),
                         sorted(["shared.search", "shared.search.prev", "shared.search.part"]))
        with open(path, "r+b") as file:
            file.seek(200)
            file.write(b"x")
        self.assertRaisesRegex(imtet.ImtetError, "is damaged.*the save before has .prev behind the name", imtet.Search.load, path)

    def test_where_every_design_fails_the_front_says_why(self):
        s = imtet.Search([0] * 4, [1] * 4, 2, evaluations=40)
        while not s.done:
            X = s.ask(7)
            s.tell(X, [None, *[RuntimeError("no licence")] * (len(X) - 1)])
        self.assertRaisesRegex(imtet.ImtetError, "none of 40 simulations succeeded; 34 failed with: RuntimeError: no licence", s.front)
        self.assertEqual(len(s.told()[0]), 40)

    def test_handles_cannot_be_copied_and_values_can(self):
        scene = imtet.Scene(None, **SIX)
        for handle in (search(), scene):
            for copied in (copy.copy, copy.deepcopy, pickle.dumps):
                self.assertRaisesRegex(TypeError, f"a {type(handle).__name__} cannot be copied or pickled: ", copied, handle)
        r = scene.simulate(gaps=0.004, thickness=0.02)
        for other in (copy.copy(r), pickle.loads(pickle.dumps(r))):
            self.assertEqual((other.j1_m, other.names), (r.j1_m, r.names))
            self.assertRaisesRegex(ValueError, "a copy, which has no scene", other.history)

    def test_a_driver_that_is_killed_at_random_moments_loses_nothing(self):
        state = os.path.join(PLACE, "killed.search")
        dice, kills, begin = random.Random(3), 0, time.monotonic()
        subprocess.run([sys.executable, driver(), state], check=True)
        whole = time.monotonic() - begin
        os.remove(state)
        for _ in range(int(os.environ.get("PYTHON_KILLS", 12))):
            child = subprocess.Popen([sys.executable, driver(), state])
            try:
                child.wait(whole * dice.random())
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
                kills += 1
            if child.returncode == 0:
                np.testing.assert_array_equal(np.load(state + ".npy"), np.hstack(drive(search()).told()[:2]))
                os.remove(state)
        print(kills, "kills", file=sys.stderr)
        self.assertGreater(kills, 0)
        subprocess.run([sys.executable, driver(), state], check=True)
        np.testing.assert_array_equal(np.load(state + ".npy"), np.hstack(drive(search()).told()[:2]))

    def test_ctrl_c_ends_a_driver(self):
        # in the background of a script it is ignored
        code = ("import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); sys.argv = ['', %r]; sys.path.insert(0, %r)\n"
                "from test_imtet import *\nprint('ready', flush=True)\n"
                "while True: drive(search())") % (PLACE, os.path.dirname(os.path.abspath(__file__)))
        child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        child.stdout.readline()
        child.send_signal(signal.SIGINT)
        self.assertIn("KeyboardInterrupt", child.communicate(timeout=60)[1])


class Simulating(unittest.TestCase):
    def test_results_are_attributes_and_histories_arrays(self):
        scene = imtet.Scene(None, **SIX)
        r = scene.simulate(gaps=0.004, thickness=(0.02, 0.01))
        self.assertEqual((r.outcome, r.peak_drift_m.shape), ("ok", (6,)))
        self.assertEqual(r.j1_m, r.peak_displacement_m.max())
        h = r.history(every=0.01)
        self.assertEqual(h.floor_m.shape, (len(h.t_s), 6))
        self.assertLessEqual(np.diff(h.t_s).max(), 0.01 * (1 + 1e-9))
        self.assertAlmostEqual(abs(h.floor_m).max(), r.j1_m, delta=0.02 * r.j1_m)
        self.assertGreater(scene.simulate(kind="no_core").j1_m, 0)
        for every in (-1, math.nan, 1e7, "x"):
            self.assertRaisesRegex(ValueError, f"every is {every!r}, wanted seconds", r.history, every)
        with self.assertRaisesRegex(AttributeError, "no result is called j1; did you mean j1_m?.* there are j1_m, j2_m, j3_g"):
            r.j1
        with self.assertRaisesRegex(AttributeError, "did you mean peak_drift_m?"):
            r.peak_drft_m
        self.assertFalse(hasattr(r, "j1"))
        self.assertRaisesRegex(TypeError, "x and gaps, side_m are given: give x alone", scene.simulate, scene.lower, gaps=0.004, side_m=3)
        with self.assertRaisesRegex(ValueError, "no variable of this scene: side_m"):
            scene.simulate(kind="no_core", gaps=0.004, thickness=0.01, side_m=3)
        for wrong, words in ((dict(gaps=[1, 2], thickness=0.01), r"gaps has shape \(2,\), wanted one number or \(6,\)"),
                             (dict(gaps=0.01), "missing: t_base_m, t_top_m"),
                             (dict(gaps=0.01, thickness=0.01, side_m=3), "no variable of this scene: side_m"),
                             (dict(x=np.ones((2, 4))), r"x has shape \(2, 4\), wanted \(8,\)")):
            self.assertRaisesRegex((ValueError, imtet.ImtetError), words, scene.simulate, **wrong)

    def test_other_threads_run_while_one_simulates(self):
        scene, ticks, stop = imtet.Scene(), [0], threading.Event()

        def tick():
            while not stop.is_set():
                ticks[0] += 1
        thread = threading.Thread(target=tick)
        thread.start()
        gained = 0
        for _ in range(50):
            before = ticks[0]
            library.call("imtet_scene_history", scene._scene, b"no_core", None, 0, ctypes.c_double(1e-3),
                         ctypes.byref(library.handle()))
            gained = max(gained, ticks[0] - before)
            if gained > 1000:
                break
        stop.set()
        thread.join()
        self.assertGreater(gained, 1000)

    def test_a_run_has_its_front_and_simulates_its_designs(self):
        out = os.path.join(PLACE, "six")
        program("optimize", "configs/quick.ini", "--out", out, "--max-evals", "60", "--threads", "1", *SHORT, "--set", "motion.stretch=1")
        run = imtet.open_run(out)
        written = np.genfromtxt(os.path.join(out, "front.csv"), delimiter=",", names=True)
        self.assertEqual(len(run.front), len(written))
        for name in ("id", "t_top_m", *run.objectives):
            np.testing.assert_array_equal(run.front[name], written[name])
        row = [r for r in run.designs if r.outcome == "ok" and r.kind == "sampled"][3]
        again = run.simulate(int(row.id))
        self.assertAlmostEqual(again.j1_m, row.j1_m, delta=0.02 * row.j1_m)
        self.assertEqual(again.mcore_kg, row.mcore_kg)
        named = [n for n, level in run._levels.items() if level > 0]
        for number in named[:3]:
            for name in run.objectives:
                self.assertAlmostEqual(run.simulate(number)[name], run.design(number)[name], delta=1e-6 * abs(run.design(number)[name]))
        self.assertGreater(len(named), 0)
        self.assertRaisesRegex(KeyError, "no design has the id 100000", run.design, 100000)
        self.assertRaisesRegex(KeyError, "'knee' is not an id", run.simulate, "knee")
        self.assertRaisesRegex(FileNotFoundError, "no run is there", imtet.open_run, PLACE)
        said = json.loads(program("evaluate", out, "--design", "knee", "--json"))["verdict"]
        self.assertEqual(run.verdict(int(run.knee.id)), said)
        self.assertIn("Against no core", said)
        self.assertRaisesRegex(KeyError, f"imtet report {out} --design 100000", run.verdict, 100000)

    def test_a_run_that_is_not_what_was_written_is_refused_as_the_program_does(self):
        whole, other = os.path.join(PLACE, "whole"), os.path.join(PLACE, "other")
        program("optimize", "configs/quick.ini", "--out", whole, "--max-evals", "28", "--threads", "1", "--set", "search.initial=16",
                "--set", "search.population=12", *SHORT)
        run = imtet.open_run(whole)
        self.assertEqual(json.loads(program("optimize", whole, "--json"))["knee"]["design"], run.knee.id)
        self.assertEqual(run.best("j3_g").j3_g, run.front.j3_g.min())
        self.assertEqual(run.best("ed5_10_pct").ed5_10_pct, run.front.ed5_10_pct.max())
        self.assertRaisesRegex(KeyError, "'j4' is not an objective of this run; it has j1_m", run.best, "j4")
        self.assertIn("28 designs" if len(run.designs) == 28 else "designs", repr(run))
        damages = (("UPDATE evaluation SET j1_m = j1_m * 1.0000000001 WHERE id = 3", "evaluation 3 is not what was written"),
                   ("UPDATE evaluation SET outcome = 'ok', reason = 'x' WHERE id = 4", "evaluation 4 is not"),
                   ("UPDATE evaluation SET generation = 7 WHERE id = 5", "evaluation 5 is not"),
                   ("UPDATE finer SET j1_m = 1 WHERE id IN (SELECT id FROM finer LIMIT 1)", "(evaluation|finer) [0-9]+ is not"),
                   ("DELETE FROM evaluation WHERE id = 6", "evaluation (6 )?is missing|an evaluation is missing"),
                   ("UPDATE front SET left = 1 WHERE evaluation IN (SELECT evaluation FROM front WHERE left IS NULL LIMIT 1)",
                    "its front is not what was written"),
                   ("UPDATE run SET settings = replace(settings, 'seed = 1', 'seed = 2')", "settings are not|is not what was written"),
                   ("CREATE VIEW v AS SELECT 1", "holds views or triggers"),
                   ("ALTER TABLE run RENAME TO old; CREATE VIEW run AS WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM r) "
                    "SELECT n AS settings, n AS provenance, n AS planned_evals, n AS n_var, n AS digest FROM r WHERE n < 0", "holds views"),
                   ("PRAGMA user_version = 9", "has format 9"), ("PRAGMA application_id = 1", "is no database of a run"))
        for sql, said in damages:
            shutil.rmtree(other, ignore_errors=True)
            shutil.copytree(whole, other)
            db = sqlite3.connect(os.path.join(other, "run.sqlite"))
            db.executescript(sql)
            db.commit()
            db.close()
            with self.subTest(sql):
                self.assertRaisesRegex(imtet.ImtetError, said, imtet.open_run, other)
                self.assertRaises(imtet.ImtetError, imtet.merge_fronts, whole, other)
                refused = subprocess.run([PROGRAM, "export", other, "--csv", "-"], capture_output=True, text=True)
                self.assertIn(refused.returncode, (65, 74), refused.stderr)
        pathlib.Path(other, "run.sqlite").write_bytes(b"SQLite format 3\0" + bytes(5000))
        self.assertRaises(imtet.ImtetError, imtet.open_run, other)

    @NEEDS_PANDAS
    def test_of_a_run_a_table_has_its_designs(self):
        run = imtet.open_run(os.path.join(PLACE, "six"))
        table = run.to_frame(front=True)
        np.testing.assert_array_equal(table.index, run.front.id)
        np.testing.assert_array_equal(table.j1_m, run.front.j1_m)
        self.assertEqual(len(run.to_frame()), len(run.designs))

    def test_fronts_of_runs_of_one_problem_are_merged_and_of_two_refused(self):
        def run(name, *more):
            program("optimize", "configs/quick.ini", "--out", os.path.join(PLACE, name), "--max-evals", "28", "--threads", "1", "--set", "search.initial=16",
                    "--set", "search.population=12", "--set", "search.polish=0", *SHORT, *more)
            return os.path.join(PLACE, name)
        a, b, c = run("a"), run("b", "--set", "search.seed=2"), run("c", "--set", "motion.stretch=2")
        merged, of = imtet.merge_fronts(a, b)
        every = np.concatenate([np.asarray(imtet.open_run(r).front) for r in (a, b)])
        senses = [-1 if n in ("ed5_10_pct", "edcs_pct") else 1 for n in imtet.open_run(a).objectives]
        F = np.column_stack([s * every[n] for s, n in zip(senses, imtet.open_run(a).objectives)])
        best = [i for i, f in enumerate(F) if not any((g <= f).all() and (g < f).any() for g in F)]
        np.testing.assert_array_equal(merged.t_top_m, every["t_top_m"][best])
        self.assertEqual(set(of), {0, 1})
        again, _ = imtet.merge_fronts(a, a)
        self.assertEqual(len(again), len(imtet.open_run(a).front))
        self.assertRaisesRegex(ValueError, "are runs of two problems: motion.stretch 3.1 and 2", imtet.merge_fronts, a, b, c)

    def test_a_record_is_read(self):
        dt, a, meta = imtet.read_motion("builtin:kobe-like", pga_g=0.1)
        self.assertAlmostEqual(abs(a).max(), 0.981)
        self.assertTrue(dt > 0 and a.ndim == 1 and meta["format"] == "builtin")


class Packaging(unittest.TestCase):
    def needs(self, *modules):
        missing = [m for m in modules if importlib.util.find_spec(m) is None]
        if missing:
            self.skipTest(f"{', '.join(missing)} not here")

    def test_a_wheel_holds_the_library(self):
        self.needs("pip", "setuptools", "wheel", "venv", "ensurepip")
        place, source = os.path.join(PLACE, "venv"), os.path.join(PLACE, "tree")
        os.mkdir(source)
        for name in os.listdir(ROOT):  # pip writes beside setup.py
            if name != "python":
                os.symlink(os.path.abspath(os.path.join(ROOT, name)), os.path.join(source, name))
        shutil.copytree(os.path.join(ROOT, "python"), os.path.join(source, "python"))
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", place], check=True)
        python = os.path.join(place, "bin", "python")
        subprocess.run([python, "-m", "pip", "install", "-q", "--no-build-isolation", "--no-index", "./python"], check=True, cwd=source,
                       env={k: v for k, v in os.environ.items() if not k.startswith("MAKE")}, capture_output=True)
        alone = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "IMTET_LIBRARY", "LD_LIBRARY_PATH")}

        def run(*words):
            return subprocess.run([python, *words], check=True, cwd="/", env=alone, capture_output=True, text=True).stdout
        said = run("-c", "import imtet; print(imtet.__version__, imtet._library.lib._name); print(imtet.Scene().simulate(kind='no_core').j1_m)")
        self.assertRegex(said, rf"^{imtet.__version__} {place}/.*/site-packages/imtet/libimtet.so\n0.")
        self.assertIn("Version: " + imtet.__version__, run("-m", "pip", "show", "imtet"))

    def test_every_public_function_has_a_docstring(self):
        for name in imtet.__all__:
            thing = getattr(imtet, name)
            if callable(thing):
                self.assertTrue(thing.__doc__, name)
                for part, value in vars(thing).items() if isinstance(thing, type) else ():
                    if not part.startswith("_") and (callable(value) or isinstance(value, property)):
                        self.assertTrue(value.__doc__, f"{name}.{part}")


class Examples(unittest.TestCase):
    def test_every_example_runs(self):
        folder = os.path.join(ROOT, "python", "examples")
        for name in sorted(os.listdir(folder)):
            if name.endswith(".py") and (name != "optuna_sampler.py" or importlib.util.find_spec("optuna")):
                done = subprocess.run([sys.executable, os.path.join(folder, name)], capture_output=True, text=True, cwd=PLACE,
                                      env={**os.environ, "PYTHONPATH": os.path.join(ROOT, "python"), "IMTET_QUICK": "1"})
                self.assertEqual(done.returncode, 0, name + ": " + done.stderr)

    def test_the_ten_lines_of_the_readme_run(self):
        names = {}
        exec(pathlib.Path(ROOT, "python", "README.md").read_text().split("```python\n")[1].split("```")[0], names)
        self.assertGreater(len(names["F"]), 3)


if __name__ == "__main__":
    unittest.main()
