"""Suites of missions, each one command, on as many missions as you like, failures counted."""

from dynastar.bench.runner import SUITES, Mission, Options, Suite, load_suite, run_suite

__all__ = ["SUITES", "Mission", "Options", "Suite", "load_suite", "run_suite"]
