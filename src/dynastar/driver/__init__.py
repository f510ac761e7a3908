"""The navigator by cost-to-go, in development: what is to replace ``dwa`` and ``navigator``.

It is one of the controllers of ``dynastar bench`` (``--controller cost_to_go``), and takes their
place when it does at least as well in every suite.
"""

from dynastar.driver.navigator import CostToGoNavigator

__all__ = ["CostToGoNavigator"]
