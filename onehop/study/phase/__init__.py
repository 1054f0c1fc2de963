"""The phase diagram of the gain policies: where, in k_rho_min and the length of a delay, they matter."""
