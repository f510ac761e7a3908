"""The parts of `make results`: what is measured, by which command, and in about how many minutes."""

from typing import NamedTuple

from dynastar.bench.controllers import controller_named
from dynastar.bench.scoreboard import QUICK_COMPETITORS
from dynastar.bench.selection import REPORT_SEEDS
from dynastar.bench.suites.crowdnav import REPORT, SEEDS, VARIANTS
from dynastar.errors import ConfigError

DYNASTAR = ("-m", "dynastar")
INDIFFERENT = (
    "people_none"  # what the parts of other controllers among indifferent people begin with
)
MAPS_BESIDE = "maps-pure_pursuit"
VARIANT_CASES = 100  # of each variant of crowdnav


class Part(NamedTuple):
    """A command of Python that takes ``--seed`` and ``--json-out``, and its minutes on two quiet cores."""

    name: str
    minutes: int
    command: tuple[str, ...]

    @property
    def of_paper(self) -> bool:
        """Whether the command is `dynastar paper`."""
        return self.command[: len(DYNASTAR) + 1] == (*DYNASTAR, "paper")

    @property
    def shown(self) -> str:
        """The command as a reader types it; the seed of `dynastar paper` is a report seed by default."""
        seed = "" if self.of_paper else f" --seed {REPORT_SEEDS}"
        return " ".join(("dynastar", *self.command[len(DYNASTAR) :])) + seed


def bench(name: str, minutes: int, *options: str, suite: str = "") -> Part:
    """A part that is a run of ``suite``, by default of the suite of that name."""
    return Part(name, minutes, (*DYNASTAR, "bench", suite or name, *options))


def paper(name: str, minutes: int, *options: str) -> Part:
    """A part that is an experiment of `dynastar paper`."""
    return Part(name, minutes, (*DYNASTAR, "paper", name, *options))


def installed(controller: str) -> bool:
    """Whether the packages of a controller are there."""
    try:
        controller_named(controller)
    except ConfigError:
        return False
    return True


def variant_cases() -> str:
    """The first published seeds of each variant of crowdnav but the first, for ``--select``."""
    cases = REPORT[:VARIANT_CASES]
    variants = range(1, len(VARIANTS) - 1)  # the last is ORCA's
    return ",".join(str(SEEDS * variant + case) for variant in variants for case in cases)


def parts() -> list[Part]:
    """All parts, cheap ones first; those of controllers that are not installed are left out."""
    orca = SEEDS * (len(VARIANTS) - 1)
    indifferent = ("--missions", "160", "--attention", "none")
    return [
        paper("presets", 1),
        paper("figures", 1),
        bench("barn", 1),
        bench("movingai", 1),
        bench("mrpb", 1),
        bench("crowdnav", 2),
        bench(
            "crowdnav_orca",
            1,
            "--select",
            f"{orca + REPORT.start}:{orca + REPORT.stop}",
            suite="crowdnav",
        ),
        bench("office", 2, "--missions", "40"),
        bench("faults", 2),
        bench("dynabarn", 2),
        bench("dynabarn_slow", 2, "--select", "1000::2", suite="dynabarn"),
        bench("irsim", 1),
        bench("navground", 2),
        paper("table1", 2),
        bench("crowd_late", 2, suite="crowd"),
        bench("crowd_none", 2, "--attention", "none", suite="crowd"),
        bench("people_late", 3, "--missions", "160", suite="people"),
        bench(INDIFFERENT, 3, *indifferent, suite="people"),
        *(
            bench(f"{INDIFFERENT}-{name}", 3, *indifferent, "--controller", name, suite="people")
            for name in QUICK_COMPETITORS
            if installed(name)
        ),
        bench("crowdnav_variants", 5, "--select", variant_cases(), suite="crowdnav"),
        bench("maps", 5),
        bench(MAPS_BESIDE, 3, "--controller", "pure_pursuit", suite="maps"),
        bench("random", 5, "--missions", "200"),
        bench("physics", 6),
        bench("robots", 8),
        paper("clutter", 30),
        Part("scoreboard", 30, ("benchmarks/scoreboard.py",)),
        paper("table3", 90),
        paper("ladder", 50),
        paper("ablation", 80, "--worlds", "80"),
    ]
