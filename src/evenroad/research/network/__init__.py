"""The MPMC network: a message-passing network, trained to turn random points into even ones (needs torch).

``pip install "evenroad[train]"`` brings what it needs; without it the import raises NotAvailable.
"""

from evenroad.errors import NotAvailable

try:
    import safetensors as _safetensors  # noqa: F401
    import torch as _torch  # noqa: F401
except ImportError as error:
    raise NotAvailable(
        f"training the network needs {error.name}, which is not installed: pip install 'evenroad[train]'"
    ) from error

from evenroad.research.network.config import NetworkConfig as NetworkConfig
from evenroad.research.network.train import refine as refine
from evenroad.research.network.train import train as train
