"""The cache: FMUs, packages and libraries, built or unpacked once."""
