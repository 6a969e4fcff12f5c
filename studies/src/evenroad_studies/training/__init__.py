"""Making many sets, in parallel and resumable, and the bank of shipped ones."""

from evenroad_studies.training.many import anneal_many as anneal_many
from evenroad_studies.training.many import order_many as order_many
from evenroad_studies.training.many import train_many as train_many
