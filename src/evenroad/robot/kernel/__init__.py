"""The arm kernel: robots and scenes as tables, and compiled code that checks them by the batch."""
