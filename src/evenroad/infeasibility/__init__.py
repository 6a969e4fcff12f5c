"""Infeasibility: proofs that no path exists."""
