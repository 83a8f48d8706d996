"""What the tests of other makers' FMUs share."""

from pathlib import Path

import pytest
from foreign_motors import motor2, motor3


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with the motors."""
    directory = tmp_path_factory.mktemp("motors")
    motor2(directory)
    motor3(directory)
    return directory
