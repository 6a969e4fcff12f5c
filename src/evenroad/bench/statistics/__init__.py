"""Statistics of success rates: pure functions on arrays of counts, with nothing of planners in them."""

from evenroad.bench.statistics.bootstrap import percentile_interval as percentile_interval
from evenroad.bench.statistics.bootstrap import resampled_ratios as resampled_ratios
from evenroad.bench.statistics.clusters import FEW_UNITS as FEW_UNITS
from evenroad.bench.statistics.clusters import clustered_difference as clustered_difference
from evenroad.bench.statistics.clusters import clustered_rate as clustered_rate
from evenroad.bench.statistics.clusters import sign_flip_test as sign_flip_test
from evenroad.bench.statistics.fisher import fisher_exact as fisher_exact
from evenroad.bench.statistics.holm import holm as holm
from evenroad.bench.statistics.interval import Interval as Interval
from evenroad.bench.statistics.interval import wilson as wilson
from evenroad.bench.statistics.paired import bonett_price as bonett_price
from evenroad.bench.statistics.paired import mcnemar_exact as mcnemar_exact
from evenroad.bench.statistics.samples_needed import UNKNOWN_INTERVAL as UNKNOWN_INTERVAL
from evenroad.bench.statistics.samples_needed import SamplesNeeded as SamplesNeeded
from evenroad.bench.statistics.samples_needed import samples_needed as samples_needed
from evenroad.bench.statistics.sets import effective_runs as effective_runs
from evenroad.bench.statistics.sets import sets_difference as sets_difference
from evenroad.bench.statistics.sets import sets_test as sets_test
from evenroad.bench.statistics.spread import Spread as Spread
from evenroad.bench.statistics.spread import spread_over_sets as spread_over_sets
from evenroad.bench.statistics.student import student_interval as student_interval
from evenroad.bench.statistics.student import student_test as student_test
