"""imtet as a sampler of Optuna: study = optuna.create_study(directions=..., sampler=ImtetSampler(space, 2)).

The search wants the whole space beforehand: names to FloatDistribution, IntDistribution (step 1) or
CategoricalDistribution. A trial that fails or is pruned is told as failed. Tried with Debian's python3-optuna (3.1).
"""
from __future__ import annotations

from typing import Any, Optional, Sequence

import optuna
from optuna.distributions import BaseDistribution, CategoricalDistribution, FloatDistribution, IntDistribution
from optuna.samplers import BaseSampler
from optuna.study import Study, StudyDirection
from optuna.trial import FrozenTrial, TrialState

import imtet


class ImtetSampler(BaseSampler):
    """Trials of a study as designs of an `imtet.Search`.

    Parameters
    ----------
    space : dict
        Name of each parameter to its distribution.
    objectives : int
        Directions of the study.
    evaluations : int
        Trials it is planned for; beyond them parameters are drawn at random.
    **settings
        Further arguments of `imtet.Search`.
    """

    def __init__(self, space: dict[str, BaseDistribution], objectives: int, evaluations: int = 100,
                 **settings: Any) -> None:
        self._space, self._arguments = space, {"objectives": objectives, "evaluations": evaluations, **settings}
        self._search: Optional[imtet.Search] = None
        self._beyond = optuna.samplers.RandomSampler(seed=1)
        self._designs: dict[int, imtet.Designs] = {}

    def _begin(self, study: Study) -> imtet.Search:
        """The senses are the study's directions, which are not known before the first trial."""
        kinds, lower, upper = [], [], []
        for d in self._space.values():
            if isinstance(d, CategoricalDistribution):
                kinds.append("choice:" + "|".join(f"c{i}" for i in range(len(d.choices))))
                lower.append(0.0)
                upper.append(len(d.choices) - 1.0)
            elif isinstance(d, (FloatDistribution, IntDistribution)):
                kinds.append("int" if isinstance(d, IntDistribution) else "log" if d.log else "real")
                lower.append(d.low)
                upper.append(d.high)
        senses = ["max" if d == StudyDirection.MAXIMIZE else "min" for d in study.directions]
        return imtet.Search(lower, upper, kinds=kinds, senses=senses, **self._arguments)

    def infer_relative_search_space(self, study: Study, trial: FrozenTrial) -> dict[str, BaseDistribution]:
        return self._space

    def sample_relative(self, study: Study, trial: FrozenTrial, search_space: dict[str, BaseDistribution]) -> dict[str, Any]:
        self._search = self._search or self._begin(study)
        X = self._search.ask(1) if self._search.ask_ready else None
        if X is None or len(X) == 0:
            return {}
        self._designs[trial.number] = X
        return {name: d.to_external_repr(x) for (name, d), x in zip(search_space.items(), X[0])}

    def sample_independent(self, study: Study, trial: FrozenTrial, param_name: str,
                           param_distribution: BaseDistribution) -> Any:
        return self._beyond.sample_independent(study, trial, param_name, param_distribution)

    def after_trial(self, study: Study, trial: FrozenTrial, state: TrialState, values: Optional[Sequence[float]]) -> None:
        X = self._designs.pop(trial.number, None)
        if self._search and X is not None:
            self._search.tell(X, [values if state == TrialState.COMPLETE else None])


def objective(trial: optuna.Trial) -> tuple[float, float]:
    x = trial.suggest_float("x", 0, 1)
    n = trial.suggest_int("n", 1, 4)
    steel = trial.suggest_categorical("material", ["steel", "oak"]) == "steel"
    if 0.3 < x < 0.35:
        raise RuntimeError("does not converge")
    return x + 0.1 * n, (1 - x) ** 2 + 1 / n + (0 if steel else 0.2)


SPACE: dict[str, BaseDistribution] = {"x": FloatDistribution(0, 1), "n": IntDistribution(1, 4),
                                      "material": CategoricalDistribution(["steel", "oak"])}

if __name__ == "__main__":
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(directions=["minimize", "minimize"], sampler=ImtetSampler(SPACE, 2, evaluations=80))
    study.optimize(objective, n_trials=80, catch=(RuntimeError,))
    front = study.best_trials
    print(f"{len(front)} trials on the front, all of steel: {all(t.params['material'] == 'steel' for t in front)}")
