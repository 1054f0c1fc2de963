"""The radio beside ns-3 3.44: same stations, noise and thresholds (docs/radio-validation.md)."""
