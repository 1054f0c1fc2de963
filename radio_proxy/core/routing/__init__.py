"""How a message finds its way over several hops: one interface, three ways."""
