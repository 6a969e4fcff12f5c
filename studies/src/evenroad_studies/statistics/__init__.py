"""Statistics of success rates: pure functions on arrays of counts, with nothing of planners in them."""
