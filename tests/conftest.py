"""What all tests share."""

from hypothesis import settings

# the same examples every time, no database in the working directory, no hurry on a busy machine
settings.register_profile("loomfmu", derandomize=True, database=None, deadline=None, max_examples=100)
settings.load_profile("loomfmu")
