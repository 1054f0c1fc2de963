"""The live page: a mission as it runs, or any log, in a browser (docs/live.md)."""
