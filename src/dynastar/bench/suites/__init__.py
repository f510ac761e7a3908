"""Suites in which a robot drives, a module each."""
