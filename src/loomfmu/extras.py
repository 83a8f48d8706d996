"""Packages that are not installed with the package itself, but with one of its extras."""

from importlib.util import find_spec

from .errors import LoomfmuError, listed

EXTRAS = {  # the packages of each, by the names under which they are imported
    "cam": ("ezdxf",),
    "native": ("ziglang",),
    "plot": ("matplotlib",),
    "proof": ("flint",),
    "report": ("jinja2",),
    "study": ("SALib", "filelock", "tomlkit"),
    "sweep": ("dask", "distributed", "filelock", "pyarrow"),
    "xarray": ("h5netcdf", "netCDF4", "xarray"),
}


def installed(extra: str) -> bool:
    """Return whether all packages of an extra can be imported."""
    return all(find_spec(package) is not None for package in EXTRAS[extra])


def install(*extras: str) -> str:
    """The command that installs extras.

    >>> install("sweep", "plot")
    'pip install "loomfmu[sweep,plot]"'
    """
    return f'pip install "loomfmu[{",".join(extras)}]"'


def need(what: object, *extras: str) -> None:
    """Say before the work begins, and before any import, which extras it needs that are not installed.

    Raises LoomfmuError that names all of them and how to install them.
    """
    if missing := [extra for extra in extras if not installed(extra)]:
        names = listed(f'"{extra}"' for extra in missing)
        raise LoomfmuError(f"{what} needs the extra{'s' * (len(missing) > 1)} {names}: {install(*missing)}")
