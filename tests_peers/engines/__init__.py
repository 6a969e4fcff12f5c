"""Other people's engines behind our protocol, to compare with: Klamp't and pinocchio."""
