"""The radio beside ns-3 3.44: the same stations, noise and thresholds on both (docs/radio-validation.md)."""
