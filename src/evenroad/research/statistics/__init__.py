"""Statistics of success rates: pure functions on arrays of counts, with nothing of planners in them."""

from evenroad.research.statistics.paired import bonett_price as bonett_price
from evenroad.research.statistics.paired import mcnemar_exact as mcnemar_exact
from evenroad.research.statistics.paired import student_interval as student_interval
from evenroad.research.statistics.paired import student_test as student_test
from evenroad.research.statistics.rates import Interval as Interval
from evenroad.research.statistics.rates import fisher_exact as fisher_exact
from evenroad.research.statistics.rates import holm as holm
from evenroad.research.statistics.rates import wilson as wilson
from evenroad.research.statistics.resampling import UNKNOWN_INTERVAL as UNKNOWN_INTERVAL
from evenroad.research.statistics.resampling import SamplesNeeded as SamplesNeeded
from evenroad.research.statistics.resampling import percentile_interval as percentile_interval
from evenroad.research.statistics.resampling import resampled_ratios as resampled_ratios
from evenroad.research.statistics.resampling import samples_needed as samples_needed
from evenroad.research.statistics.units import FEW_UNITS as FEW_UNITS
from evenroad.research.statistics.units import Spread as Spread
from evenroad.research.statistics.units import clustered_difference as clustered_difference
from evenroad.research.statistics.units import clustered_rate as clustered_rate
from evenroad.research.statistics.units import effective_runs as effective_runs
from evenroad.research.statistics.units import sets_difference as sets_difference
from evenroad.research.statistics.units import sets_test as sets_test
from evenroad.research.statistics.units import sign_flip_test as sign_flip_test
from evenroad.research.statistics.units import spread_over_sets as spread_over_sets
