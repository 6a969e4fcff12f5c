"""Problems for arms: robots, cells and tasks at random, and how few points a roadmap needs for them."""
