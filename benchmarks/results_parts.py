"""The parts of `make results`: what is measured, by which command, and in about how many minutes."""

from importlib.util import find_spec
from typing import NamedTuple

from dynastar.bench.controllers import controller_named
from dynastar.bench.scoreboard import QUICK_COMPETITORS
from dynastar.bench.selection import REPORT_SEEDS
from dynastar.bench.suites.crowdnav import REPORT, SEEDS, VARIANTS
from dynastar.errors import ConfigError
from dynastar.simulation.crowd import jupedsim_installed

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


def missing() -> list[str]:
    """The extras that parts need and that are not installed."""
    needs = {"kompass": installed("kompass_dwa"), "crowdnav": installed("orca")}
    needs |= {"pedestrians": jupedsim_installed(), "irsim": find_spec("irsim") is not None}
    needs |= {"navground": find_spec("navground") is not None}
    needs |= {"physics": find_spec("mujoco") is not None}
    return [extra for extra, there in needs.items() if not there]


def variant_cases() -> str:
    """The first published seeds of each other variant of crowdnav, for ``--select``; of ``told`` all."""
    told = next(number for number, one in enumerate(VARIANTS) if one.told)
    some = dict.fromkeys(range(1, len(VARIANTS) - 1), REPORT[:VARIANT_CASES])  # the last is ORCA's
    cases = some | {told: REPORT}
    return ",".join(
        f"{SEEDS * number + of.start}:{SEEDS * number + of.stop}" for number, of in cases.items()
    )


def parts() -> list[Part]:
    """All parts, cheap ones first."""
    orca = SEEDS * (len(VARIANTS) - 1)
    late = ("--missions", "160", "--select", "0::4,1::4,2::4")
    indifferent = (*late, "--attention", "none")
    reactive = ("--missions", "300", "--select", "3::4")
    return [
        paper("presets", 1),
        paper("figures", 1),
        bench("barn", 2),
        bench("movingai", 1),
        bench("mrpb", 2),
        bench("crowdnav", 2),
        bench(
            "crowdnav_orca",
            1,
            "--select",
            f"{orca + REPORT.start}:{orca + REPORT.stop}",
            suite="crowdnav",
        ),
        bench("office", 3, "--missions", "40"),
        bench("faults", 4),
        bench("dynabarn", 4),
        bench("dynabarn_slow", 4, "--select", "1000::2", suite="dynabarn"),
        bench("irsim", 2),
        bench("navground", 1),
        paper("table1", 2),
        bench("crowd_late", 4, suite="crowd"),
        bench("crowd_none", 4, "--attention", "none", suite="crowd"),
        bench("people_late", 7, *late, suite="people"),
        bench(INDIFFERENT, 6, *indifferent, suite="people"),
        bench("people_reactive", 8, *reactive, suite="people"),
        *(
            bench(f"{INDIFFERENT}-{name}", 5, *indifferent, "--controller", name, suite="people")
            for name in QUICK_COMPETITORS
        ),
        bench("crowdnav_variants", 5, "--select", variant_cases(), suite="crowdnav"),
        bench("maps", 8),
        bench(MAPS_BESIDE, 7, "--controller", "pure_pursuit", suite="maps"),
        bench("random", 8, "--missions", "200"),
        bench("physics", 4),
        bench("robots", 9),
        paper("clutter", 35),
        Part("scoreboard", 30, ("benchmarks/scoreboard.py",)),
        paper("table3", 80),
        Part("contact_causes", 4, ("benchmarks/contact_causes.py",)),
        paper("ladder", 50),
        paper("ablation", 45, "--worlds", "50"),
    ]
