"""The viewer layer: what Foxglove and Rerun can decode, beside the wire channels that they cannot."""
