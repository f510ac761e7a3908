"""What a notebook shows of an episode: a function that the top of the package sets.

An episode calls it, and so need not import the page, which is made of episodes.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:  # ``import dynastar`` imports neither
    from collections.abc import Callable
    from typing import Any

episode_html: "Callable[[Any], str]"
