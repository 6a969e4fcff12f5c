from types import ModuleType

VARIANT: str
kernel: ModuleType
