"""The suites by name, each a module with the names of ``dynastar.bench.missions.Suite``."""

from importlib import import_module

from dynastar.config import choose
from dynastar.errors import DataError

TYPE_CHECKING = False
if TYPE_CHECKING:  # not imported for --help
    from dynastar.bench.missions import Suite

SUITES = {
    "movingai": "dynastar.bench.movingai",
    "paper": "dynastar.bench.paper",
    "barn": "dynastar.bench.suites.barn",
    "dynabarn": "dynastar.bench.suites.dynabarn",
    "mrpb": "dynastar.bench.suites.mrpb",
    "crowd": "dynastar.bench.suites.crowd",
    "maps": "dynastar.bench.suites.maps",
    "office": "dynastar.bench.suites.office",
    "faults": "dynastar.bench.suites.faults",
    "random": "dynastar.bench.suites.random_worlds",
    "bounds": "dynastar.bench.suites.bounds",
    "people": "dynastar.bench.suites.people",
    "robots": "dynastar.bench.suites.robots",
    "crowdnav": "dynastar.bench.suites.crowdnav",
    "physics": "dynastar.bench.suites.physics",
    "irsim": "dynastar.bench.suites.irsim",
    "navground": "dynastar.bench.suites.navground",
    "scenarios": "dynastar.bench.suites.scenarios",
}

WITHOUT_DATA = (  # suites that make their missions themselves
    *("paper", "faults", "random", "bounds", "people", "robots"),
    *("crowdnav", "physics", "irsim", "navground"),
)


def load_suite(name: str) -> "Suite":
    """The suite of that name; ConfigError, with the nearest name, if there is none.

    DataError if it needs a package that is not installed.
    """
    try:
        return import_module(choose(name, SUITES, "suite"))
    except ModuleNotFoundError as error:
        raise DataError(
            f"the suite {name} needs the package {error.name}, which is not installed; docs/extras.md "
            "says which extra has it"
        ) from None
