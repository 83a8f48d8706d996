"""The dobby drive, and the peaks of its smooth laws."""
