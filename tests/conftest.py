"""How hypothesis tries its examples in all tests: for as long as they take, also on a machine that is busy."""

from hypothesis import settings

settings.register_profile("patient", deadline=None)
settings.load_profile("patient")
