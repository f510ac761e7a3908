"""The next setting to try, proposed by Optuna [Akiba2019] from what the others came to."""

from collections.abc import Sequence
from typing import Any

from dynastar.extras import require
from dynastar.tune.space import Parameter
from dynastar.tune.state import Row, Trial

RANDOM_FIRST = 10  # settings drawn at random before the model has a say


def propose(
    space: Sequence[Parameter], trials: Sequence[Trial], default: Sequence[Row], seed: int
) -> dict[str, float]:
    """The next setting, by the tree-structured Parzen estimator; the same trials give the same one.

    A trial that was stopped counts by how far it came, then by its mean loss.
    """
    optuna = _optuna()
    sampler = optuna.samplers.TPESampler(seed=seed + len(trials), n_startup_trials=RANDOM_FIRST)
    study = optuna.create_study(sampler=sampler)
    states = optuna.trial.TrialState
    for trial in trials:
        mean = trial.mean(default)
        study.add_trial(
            optuna.trial.create_trial(
                params=trial.values,
                distributions=_distributions(space),
                state=states.PRUNED if trial.stopped else states.COMPLETE,
                value=None if trial.stopped else mean,
                intermediate_values={len(trial.rows): mean},
            )
        )
    return dict(study.ask(_distributions(space)).params)


def importances(
    space: Sequence[Parameter], trials: Sequence[Trial], default: Sequence[Row]
) -> dict[str, float]:
    """How much each parameter separates good settings from others, by PED-ANOVA [Watanabe2023].

    Fractions of 1, the largest first; nothing with too few trials. A trial counts by its mean loss less
    the default's, 1.02, in the worlds that it drove.
    """
    if len(trials) < RANDOM_FIRST or len({trial.mean(default) for trial in trials}) < 2:
        return {}
    optuna = _optuna()
    study = optuna.create_study()
    for trial in trials:
        study.add_trial(
            optuna.trial.create_trial(
                params=trial.values, distributions=_distributions(space), value=trial.mean(default)
            )
        )
    evaluator = optuna.importance.PedAnovaImportanceEvaluator()
    found: dict[str, float] = optuna.importance.get_param_importances(study, evaluator=evaluator)
    return found


def _distributions(space: Sequence[Parameter]) -> dict[str, Any]:
    make = _optuna().distributions.FloatDistribution
    return {one.name: make(one.low, one.high, log=one.log) for one in space}


def _optuna() -> Any:
    require("tune", "tuning needs")
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna
