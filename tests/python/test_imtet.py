"""python/imtet.py against the program and against itself. test_imtet.py FOLDER: where its files go; $IMTET is the program."""
import copy
import math
import os
import pickle
import random
import signal
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

PLACE, PROGRAM = os.path.abspath(sys.argv.pop(1)), os.environ["IMTET"]
SETTINGS = {"initial": 16, "population": 12, "threads": 1}
SIX = {"building.model": os.path.join(ROOT, "configs/neighbours/tower"), "core.width_m": 5, "design.gap_m": "0.001,0.05",
       "motion.pga_g": 0.3}
SHORT = [w for k, v in {**SIX, "motion.record": "builtin:elcentro-like", "sim.duration_s": 8}.items() for w in ("--set", f"{k}={v}")]


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
    with open(name, "w") as out:
        out.write(DRIVER.format(place=PLACE, here=os.path.dirname(os.path.abspath(__file__))))
    return name


def program(*words):
    return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True, cwd=ROOT).stdout


class Searching(unittest.TestCase):
    def test_designs_are_those_of_optimize_with_the_same_function_as_a_worker(self):
        worker = os.path.join(PLACE, "worker.py")
        with open(worker, "w") as out:
            out.write("import json, math, sys\nfor line in sys.stdin:\n    r = json.loads(line)\n    x = r['x']\n"
                      "    a = {'f': [x[0], (1 - math.sqrt(x[0])) + sum((v - 0.5) ** 2 for v in x[1:])]}\n"
                      "    print(json.dumps({'id': r['id'], **({'error': 'no'} if 0.30 < x[0] < 0.42 else a)}), flush=True)\n")
        with open(os.path.join(PLACE, "w.ini"), "w") as out:
            out.write(f"[problem]\nkind = external\ncommand = python3 {worker}\nvariables = 4\nobjectives = 2\n[search]\n"
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
            with self.assertRaisesRegex(ValueError, f"n is {n!r}, wanted an int: how many designs"):
                search().ask(n)
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
        with self.assertRaisesRegex(ValueError, r"X has shape \(3, 2\), wanted \(n, 4\)"):
            s.tell(X[:, :2], np.ones((3, 2)))
        for Y, words in ((np.ones((2, 2)), r"X has 3 rows, Y 2: wanted shape \(3, 2\)"),
                         (np.ones((3, 3)), r"row 0 of Y has shape \(3,\), wanted \(2,\)"),
                         (None, r"Y is None, wanted rows of shape \(3, 2\)"),
                         ([[1, 2], ["a", "b"], [1, 2]], r"row 1 of Y: .*'a'; wanted numbers of shape \(2,\)")):
            with self.assertRaisesRegex(ValueError, words):
                s.tell(X, Y)
        with self.assertRaisesRegex(ValueError, r"row 0 of Y is no tuple \(f, g\), and there is no G of shape \(1, 1\)"):
            bounded = imtet.Search([0] * 3, [1] * 3, 2, constraints=1)
            bounded.tell(bounded.ask(1), [[[1, 2], [3]]])
        with self.assertRaisesRegex(imtet.ImtetError, "3 designs were asked for and never told"):
            s.tell(np.empty((0, 4)), [])
        with self.assertRaisesRegex(ValueError, "row 1 of X was not asked for"):
            s.tell(np.array([X[0], X[1] + 1e-9, X[2]]), np.ones((3, 2)))
        with self.assertRaisesRegex(imtet.ImtetError, "F of design 2: number 1 is nan"):
            s.tell(X, [[1, 2], [math.nan, 2], [1, 2]])
        with self.assertRaisesRegex(ValueError, "X: .*wanted numbers of shape"):
            s.tell([["a", "b"]], [[1, 2]])
        self.assertEqual(s.state["told"], 0)
        s.tell(X, np.ones((3, 2)))
        with self.assertRaisesRegex(ValueError, "told already"):
            s.tell(X, np.ones((3, 2)))
        with self.assertRaisesRegex(imtet.ImtetError, "did you mean search.population"):
            search(populaton=3)
        with self.assertRaisesRegex(imtet.ImtetError, "is no saved search"):
            imtet.Search.load(__file__)
        with self.assertRaisesRegex(ValueError, "objectives is -1, wanted a whole number of 1 or more"):
            imtet.Search([0], [1], objectives=-1)
        with self.assertRaisesRegex(imtet.ImtetError, "start: variable 2 of design 1 is 3.5; it is a whole number"):
            imtet.Search([0, 0], [1, 5], 2, kinds="real,int", start=[[0.5, 3.5]])

    def test_where_every_design_fails_the_front_says_why(self):
        s = imtet.Search([0] * 4, [1] * 4, 2, evaluations=40)
        while not s.done:
            X = s.ask(7)
            s.tell(X, [None, *[RuntimeError("no licence")] * (len(X) - 1)])
        with self.assertRaisesRegex(imtet.ImtetError, "none of 40 simulations succeeded; 34 failed with: RuntimeError: no licence"):
            s.front()
        self.assertEqual(len(s.told()[0]), 40)

    def test_handles_cannot_be_copied_and_values_can(self):
        scene = imtet.Scene(None, **SIX)
        for handle in (search(), scene):
            for copied in (copy.copy, copy.deepcopy, pickle.dumps):
                with self.assertRaisesRegex(TypeError, f"a {type(handle).__name__} cannot be copied or pickled: "):
                    copied(handle)
        r = scene.simulate(gaps=0.004, thickness=0.02)
        for other in (copy.copy(r), pickle.loads(pickle.dumps(r))):
            self.assertEqual((other.j1_m, other.names), (r.j1_m, r.names))
            with self.assertRaisesRegex(ValueError, "a copy, which has no scene"):
                other.history()

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
            with self.assertRaisesRegex(ValueError, f"every is {every!r}, wanted seconds"):
                r.history(every)
        with self.assertRaisesRegex(AttributeError, "no result is called j1; did you mean j1_m?.* there are j1_m, j2_m, j3_g"):
            r.j1
        with self.assertRaisesRegex(AttributeError, "did you mean peak_drift_m?"):
            r.peak_drft_m
        self.assertFalse(hasattr(r, "j1"))
        with self.assertRaisesRegex(TypeError, "x and gaps, side_m are given: give x alone"):
            scene.simulate(scene.lower, gaps=0.004, side_m=3)
        with self.assertRaisesRegex(ValueError, "no variable of this scene: side_m"):
            scene.simulate(kind="no_core", gaps=0.004, thickness=0.01, side_m=3)
        for wrong, words in ((dict(gaps=[1, 2], thickness=0.01), r"gaps has shape \(2,\), wanted one number or \(6,\)"),
                             (dict(gaps=0.01), "missing: t_base_m, t_top_m"),
                             (dict(gaps=0.01, thickness=0.01, side_m=3), "no variable of this scene: side_m"),
                             (dict(x=np.ones((2, 4))), r"x has shape \(2, 4\), wanted \(8,\)")):
            with self.assertRaisesRegex((ValueError, imtet.ImtetError), words):
                scene.simulate(**wrong)

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
            imtet._call("imtet_scene_history", scene._scene, b"no_core", None, 0, imtet.ctypes.c_double(1e-3),
                        imtet.ctypes.byref(imtet._handle()))
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
        with self.assertRaisesRegex(KeyError, "no design has the id 100000"):
            run.design(100000)
        with self.assertRaisesRegex(KeyError, "'knee' is no id"):
            run.simulate("knee")
        with self.assertRaisesRegex(FileNotFoundError, "no run is there"):
            imtet.open_run(PLACE)
        with self.assertRaisesRegex(FileNotFoundError, "nowhere: there is no such folder"):
            imtet.open_run(os.path.join(PLACE, "nowhere"))

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
        with self.assertRaisesRegex(ValueError, "are runs of two problems: motion.stretch 3.1 and 2"):
            imtet.merge_fronts(a, b, c)

    def test_a_record_is_read(self):
        dt, a, meta = imtet.read_motion("builtin:kobe-like", pga_g=0.1)
        self.assertAlmostEqual(abs(a).max(), 0.981)
        self.assertTrue(dt > 0 and a.ndim == 1 and meta["format"] == "builtin")


class Examples(unittest.TestCase):
    def test_every_example_runs(self):
        folder = os.path.join(ROOT, "python", "examples")
        for name in sorted(os.listdir(folder)):
            if name.endswith(".py"):
                done = subprocess.run([sys.executable, os.path.join(folder, name)], capture_output=True, text=True, cwd=PLACE,
                                      env={**os.environ, "PYTHONPATH": os.path.join(ROOT, "python"), "IMTET_QUICK": "1"})
                self.assertEqual(done.returncode, 0, name + ": " + done.stderr)

    def test_the_ten_lines_of_the_readme_run(self):
        with open(os.path.join(ROOT, "python", "README.md")) as text:
            code = text.read().split("```python\n")[1].split("```")[0]
        names = {}
        exec(code, names)
        self.assertGreater(len(names["F"]), 3)


if __name__ == "__main__":
    unittest.main()
