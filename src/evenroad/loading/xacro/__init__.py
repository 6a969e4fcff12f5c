"""Reading a xacro: expressions by a grammar of our own, and elements within a budget of work."""
