"""Onehop: robot teams held together by radio, as real processes on a real bus."""

__version__ = "0.1.0"
