"""What a run needs: the signals requested, the FMUs that can be left out, where the steps are."""
