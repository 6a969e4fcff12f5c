from evenroad.flight.flight_space import FlightSpace as FlightSpace
from evenroad.flight.flight_trajectory import FlightTrajectory as FlightTrajectory
from evenroad.flight.flight_world import FlightWorld as FlightWorld
from evenroad.flight.state import State as State
