"""Suites of missions, each one command, on as many missions as you like, failures counted."""
