"""A fuzzer for everything that comes from outside: scenarios, maps, logs, messages.

    python -m tests.fuzz --cases 5000 --seed 1

Each case is made from a seed, runs in a process of its own with limits, and ends accepted or refused in
one line.
"""
