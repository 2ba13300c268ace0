"""A worker for configs/beam.ini: the welded beam of Deb (2000), of four materials, by line welds [in, lb, psi]."""

import json
import math
import sys

#            strength  E      G      cost of weld and bar [1/in3]
MATERIALS = {"steel": (30e3, 30e6, 12e6, 0.1047, 0.0481), "cast iron": (8e3, 14e6, 6e6, 0.0489, 0.0224),
             "aluminium": (5e3, 10e6, 4e6, 0.5235, 0.2405), "brass": (8e3, 16e6, 6e6, 0.5584, 0.2566)}
P, L = 6000.0, 14.0  # load at the end, length


def beam(sides, material, weld, bar, l, t):
    strength, E, G, cost_weld, cost_bar = MATERIALS[material]
    h, b, four = weld / 16, bar / 16, sides == "four"
    length = 2 * (l + t) if four else 2 * l
    J = h / math.sqrt(2) * (l * (l * l / 6 + t * t / 2) + four * t * (t * t / 6 + l * l / 2))
    R = math.hypot(l, t) / 2
    direct, turned = P * math.sqrt(2) / (h * length), P * (L + l / 2) * R / J
    shear = math.sqrt(direct**2 + turned**2 + direct * turned * l / R)
    buckling = 4.013 * t * b**3 * math.sqrt(E * G) / (6 * L * L) * (1 - t / (4 * L) * math.sqrt(E / G))
    f = [(1 + cost_weld) * h * h * length / 2 + cost_bar * t * b * (L + l), 4 * P * L**3 / (E * b * t**3)]
    g = [shear / (0.577 * strength) - 1, 6 * P * L / (b * t * t) / strength - 1, 1 - buckling / P, h / b - 1]
    return f, g


for line in sys.stdin:
    request = json.loads(line)
    f, g = beam(*request["x"])
    print(json.dumps({"id": request["id"], "f": f, "g": g}), flush=True)
