"""The commands of `onehop`, one module each. cli.py puts them together."""
