"""The weaving loom: its instances and weaves in scenes, and the claims on its mechanisms."""

from pathlib import Path as _Path

from . import drive_claims as drive_claims  # each kind of claim in them adds itself to the kinds
from . import heald_claims as heald_claims
from . import latched_claims as latched_claims
from . import loom_claims as loom_claims
from .lifted import pegs as pegs
from .lifted import weave_of as weave_of
from .notes import added as added
from .notes import mirrored as mirrored
from .standard_loom import COMPONENT_OF as COMPONENT_OF
from .standard_loom import SOURCES as SOURCES
from .standard_loom import instances_of as instances_of
from .standard_loom import pattern as pattern
from .standard_loom import resolve as resolve

RULES = _Path(__file__).with_name("native") / "judge.c"
