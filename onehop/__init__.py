"""Onehop: robot teams held together by radio, as real processes on a real bus."""
