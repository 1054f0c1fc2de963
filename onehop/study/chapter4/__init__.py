"""Chapter 4 of the thesis again, with statistics: its missions, claims, way-finding, failing robots."""
