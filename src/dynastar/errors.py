"""Everything dynastar raises on purpose, in one tree; each message says what, where and what would do."""


class DynastarError(Exception):
    """Root of the tree: catching it catches every error that dynastar raises on purpose."""


class InputError(DynastarError):
    """Something handed to dynastar is not what it has to be."""


class ConfigError(InputError):
    """A setting has a wrong name, type or value."""


class UnknownRobot(ConfigError, KeyError):  # noqa: N818 - the name says it
    """No robot has that name."""

    __str__ = Exception.__str__  # KeyError's quotes the message


class MapError(InputError):
    """A map file is missing, malformed, truncated or too large."""


class ScenarioError(InputError):
    """A scenario is missing, malformed or contradicts itself."""


class EpisodeError(InputError):
    """An episode file is missing, malformed or of another version."""


class DataError(InputError):
    """A benchmark's data set is not where it should be, or not what it should be."""


class DynastarWarning(UserWarning):
    """Something was used, but perhaps not as it was meant; the message says what and where."""


class MissingPackage(DynastarError, ImportError):  # noqa: N818
    """A package is needed that dynastar does not install unless asked for one of its extras."""


class PlanningError(DynastarError):
    """A plan cannot be made; ``radius`` is the disc's in metres, if a planner says so."""

    radius: float | None = None


class OutOfMap(PlanningError, InputError):  # noqa: N818 - the name says it
    """A point lies outside the map."""


class StartOccupied(PlanningError, InputError):  # noqa: N818
    """The robot stands in an obstacle and no free cell is near enough to leave it."""


class GoalOccupied(PlanningError, InputError):  # noqa: N818
    """The footprint does not fit at the goal."""


class GoalObstructed(PlanningError):  # noqa: N818
    """Sensed obstacles keep the robot from the goal, and no place that it can reach is nearer."""


class NoPath(PlanningError):  # noqa: N818
    """Start and goal are free, and nothing connects them."""
