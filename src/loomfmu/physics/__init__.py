"""The mechanisms' mathematics: pure functions of numbers, lists and records that also translate to C."""
