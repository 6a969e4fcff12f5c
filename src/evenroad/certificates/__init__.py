"""Certificates: a proof that a path is free, in a file that another program checks."""

from __future__ import annotations
