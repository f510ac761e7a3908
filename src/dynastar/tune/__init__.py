"""Tuning: settings searched over simulated missions, and a robot measured from a recording."""
