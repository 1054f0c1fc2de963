"""Maps: read from files or polygons into walls, and exact questions about them."""
