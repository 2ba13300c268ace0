"""A script in the form of OpenSeesPy, searched by imtet: column stiffnesses of a shear frame of three storeys.

OpenSees is not in Debian, so that `ops` below is a solver of our own with the same few calls (model, node, mass, fix,
element, eigen, wipe). With OpenSeesPy installed: `import openseespy.opensees as ops` in its place; its state is global,
so that designs are evaluated one after another (threads=1), or in processes of their own.
"""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

import imtet


class ShearFrame:
    """Nodes in a line with masses, joined by zero-length springs in direction 1."""

    def wipe(self) -> None:
        self.masses: dict[int, float] = {}
        self.fixed: set[int] = set()
        self.springs: list[tuple[int, int, float]] = []
        self.stiffness: dict[int, float] = {}

    def model(self, *_: object) -> None:
        self.wipe()

    def node(self, tag: int, *_: object) -> None:
        self.masses[tag] = 0.0

    def mass(self, tag: int, m: float, *_: object) -> None:
        self.masses[tag] = m

    def fix(self, tag: int, *_: object) -> None:
        self.fixed.add(tag)

    def uniaxialMaterial(self, kind: str, tag: int, E: float) -> None:
        if not E > 0:
            raise ValueError(f"{kind} {tag} has no stiffness")
        self.stiffness[tag] = E

    def element(self, kind: str, tag: int, i: int, j: int, mat: str, material: int, *_: object) -> None:
        self.springs.append((i, j, self.stiffness[material]))

    def eigen(self, n: int) -> list[float]:
        free = [t for t in self.masses if t not in self.fixed]
        at = {t: k for k, t in enumerate(free)}
        K = np.zeros((len(free), len(free)))
        for i, j, k in self.springs:
            for a, b, s in ((i, i, k), (j, j, k), (i, j, -k), (j, i, -k)):
                if a in at and b in at:
                    K[at[a], at[b]] += s
        r = np.sqrt([self.masses[t] for t in free])
        return list(np.linalg.eigvalsh(K / np.outer(r, r))[:n])


ops = ShearFrame()
STOREYS, MASS = 3, 2e4  # [kg]


def frame(x: npt.NDArray[np.float64]) -> list[float]:
    """x: lg of the storeys' stiffnesses [N/m]. First period [s] and cost, both to be small."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(0, 0.0)
    ops.fix(0, 1)
    for i in range(1, STOREYS + 1):
        ops.node(i, 0.0)
        ops.mass(i, MASS)
        ops.uniaxialMaterial("Elastic", i, 10 ** x[i - 1])
        ops.element("zeroLength", i, i - 1, i, "-mat", i, "-dir", 1)
    period = 2 * np.pi / ops.eigen(1)[0] ** 0.5
    return [period, sum(10 ** v for v in x) / 1e6]


if __name__ == "__main__":
    search = imtet.Search([5] * STOREYS, [8] * STOREYS, 2, evaluations=150)
    F, X = search.run(frame)  # F before X
    print(f"{len(F)} frames, first period {F[:, 0].min():.2f} to {F[:, 0].max():.2f} s")
