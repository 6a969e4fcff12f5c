"""Results on disk: JSON for machines, CSV for spreadsheets and controllers."""

from evenroad.io.record import plan_record as plan_record
from evenroad.io.record import save_json as save_json
from evenroad.io.record import save_path_csv as save_path_csv
from evenroad.io.record import versions as versions
