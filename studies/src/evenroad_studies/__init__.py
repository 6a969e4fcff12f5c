"""The studies: what reproduces and judges the paper, and makes the shipped sets.  Only the command imports it."""
