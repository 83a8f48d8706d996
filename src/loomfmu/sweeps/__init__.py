"""Sweeps: one scene with many combinations of values, as one table.

A sweep file names a scene, what varies (`axes`, `plan`) and what is wanted. Batches of rows (`schedule`) run
in worker processes or on a dask cluster (`pools`, `cluster`, `worker`); each finished one is a file (`store`,
`tables`), so a sweep that was killed goes on. `ranking` finds the worst rows, `indices` the values that
matter, `maps` draws.
"""
