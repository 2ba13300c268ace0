"""A study of the tower, step by step as in a notebook: scene, search, front, the best design over time; pictures where
matplotlib is there. IMTET_QUICK=1: a study of seconds."""
import os

import numpy as np

import imtet

# 1. The scene: the 20-storey tower, a core of box section, a built-in motion.
quick = os.environ.get("IMTET_QUICK") == "1"
scene = imtet.Scene(None, record="builtin:kobe-like", pga_g=0.3, settings=["sim.duration_s=20"] if quick else [])
print(f"{scene.floors} floors, first frequency {scene.building_hz[0]:.2f} Hz, {len(scene.variables)} variables")

# 2. The search: all objectives of the paper, by threads, for simulate releases the GIL.
search = imtet.Search(scene.lower, scene.upper, len(scene.objectives), senses=scene.senses,
                      evaluations=60 if quick else 400)
F, X = search.run(scene.evaluate, batch=16, threads=os.cpu_count() or 1)  # F before X
print(f"{len(F)} designs on the front;", ", ".join(f"best {n} {(F[:, k].min() if s == 'min' else F[:, k].max()):.4g}"
                                                    for k, (n, s) in enumerate(zip(scene.objectives, scene.senses))))

# 3. The design of the least acceleration, beside the building alone.
best = scene.simulate(X[F[:, scene.objectives.index("j3_g")].argmin()])
alone = scene.simulate(kind="no_core")
print(f"drift {best.j2_m:.3f} m, alone {alone.j2_m:.3f} m; acceleration {best.j3_g:.2f} g, alone {alone.j3_g:.2f} g")

# 4. Pictures.
try:
    import matplotlib  # type: ignore[import]
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # type: ignore[import]
except ImportError:
    print("no matplotlib (python3-matplotlib): no pictures")
else:
    fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4))
    left.scatter(F[:, 0], F[:, 2], s=8)
    left.set(xlabel="displacement [m]", ylabel="acceleration [g]")
    for name, r in (("best", best), ("alone", alone)):
        h = r.history(every=0.02)
        right.plot(h.t_s, h.floor_m[:, -1], label=name)
    right.set(xlabel="time [s]", ylabel="roof [m]")
    right.legend()
    fig.savefig("tower_study.png", dpi=120)
    print("written: tower_study.png")
np.savetxt("tower_front.csv", F, delimiter=",", header=",".join(scene.objectives), comments="")
print("written: tower_front.csv")
