"""Statistics of success rates: pure functions on arrays of counts, with nothing of planners in them."""

from evenroad.research.statistics.bootstrap import percentile_interval as percentile_interval
from evenroad.research.statistics.bootstrap import resampled_ratios as resampled_ratios
from evenroad.research.statistics.clusters import FEW_UNITS as FEW_UNITS
from evenroad.research.statistics.clusters import clustered_difference as clustered_difference
from evenroad.research.statistics.clusters import clustered_rate as clustered_rate
from evenroad.research.statistics.clusters import sign_flip_test as sign_flip_test
from evenroad.research.statistics.fisher import fisher_exact as fisher_exact
from evenroad.research.statistics.holm import holm as holm
from evenroad.research.statistics.interval import Interval as Interval
from evenroad.research.statistics.interval import wilson as wilson
from evenroad.research.statistics.paired import bonett_price as bonett_price
from evenroad.research.statistics.paired import mcnemar_exact as mcnemar_exact
from evenroad.research.statistics.samples_needed import UNKNOWN_INTERVAL as UNKNOWN_INTERVAL
from evenroad.research.statistics.samples_needed import SamplesNeeded as SamplesNeeded
from evenroad.research.statistics.samples_needed import samples_needed as samples_needed
from evenroad.research.statistics.sets import effective_runs as effective_runs
from evenroad.research.statistics.sets import sets_difference as sets_difference
from evenroad.research.statistics.sets import sets_test as sets_test
from evenroad.research.statistics.spread import Spread as Spread
from evenroad.research.statistics.spread import spread_over_sets as spread_over_sets
from evenroad.research.statistics.student import student_interval as student_interval
from evenroad.research.statistics.student import student_test as student_test
