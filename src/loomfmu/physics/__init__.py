"""The mechanisms' mathematics: pure functions of floats that also translate to C."""
