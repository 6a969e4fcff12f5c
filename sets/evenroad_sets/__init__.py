"""The large trained point sets of evenroad, as data: ``evenroad.points.bank`` finds and checks them."""
