"""Errors of the simulated senses."""

import numpy as np
import numpy.typing as npt


def cut_gaussian(random: np.random.Generator, bound: float, count: int) -> npt.NDArray[np.float64]:
    """``count`` errors: Gaussian with half the bound as deviation, cut at +-``bound``."""
    return np.clip(random.normal(0.0, 0.5, count), -1.0, 1.0) * bound
