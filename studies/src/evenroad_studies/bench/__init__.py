"""Benchmarks: problems, samplers and rules, run as tasks, one row each, and read with statistics."""
