"""Traces as other programs read them: every value and every attribute, as h5py has them."""

import re
import shutil
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import loomfmu

SIMS = Path(__file__).parents[2] / "sims"
SCENES = ("wl680_3600", "both_rapiers", "satin")
PLACES = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME")  # attributes by which HDF5 joins datasets

Found = Mapping[str, Any]  # values by the path of a dataset, attributes by that of their owner and @


@pytest.fixture(scope="module", params=SCENES)
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The trace of one scene, of few steps."""
    output = tmp_path_factory.mktemp("readers") / f"{request.param}.h5"
    scene = SIMS / f"{request.param}.toml"
    return loomfmu.run(scene, set={"steps_per_revolution": 90, "revolutions": 1}, output=output).path


@pytest.fixture(scope="module")
def written(path: Path) -> Found:
    """Values and attributes by h5py."""
    found: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        found.update({f"/{name}@{key}": value for key, value in item.attrs.items() if key not in PLACES})
        if isinstance(item, h5py.Dataset):
            found[f"/{name}"] = item[:]

    with h5py.File(path) as file:
        visit("", file)
        for name, item in file.items():
            visit(name, item)
            for variable in item if isinstance(item, h5py.Group) else ():
                visit(f"{name}/{variable}", item[variable])
    return found


def by_netcdf4(path: Path) -> Found:
    netcdf4 = pytest.importorskip("netCDF4")
    found: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        found.update({f"{name or '/'}@{key}": item.getncattr(key) for key in item.ncattrs()})
        for key, variable in item.variables.items():
            found[f"{name}/{key}"] = variable[:].data
            owner = f"{name}/{key}"
            found.update({f"{owner}@{each}": variable.getncattr(each) for each in variable.ncattrs()})
        for key, group in item.groups.items():
            visit(f"{name}/{key}", group)

    with netcdf4.Dataset(path) as file:
        file.set_auto_mask(False)
        visit("", file)
    return found


def by_xarray(engine: str) -> Callable[[Path], Found]:
    def read(path: Path) -> Found:
        xarray = pytest.importorskip("xarray")
        pytest.importorskip({"h5netcdf": "h5netcdf", "netcdf4": "netCDF4"}[engine])
        found: dict[str, Any] = {}
        with xarray.open_datatree(path, engine=engine, decode_cf=False) as tree:
            for node in tree.subtree:
                name = node.path.rstrip("/")
                found.update({f"{node.path}@{key}": value for key, value in node.attrs.items()})
                for key, variable in node.variables.items():
                    found[f"{name}/{key}"] = variable.values
                    found.update({f"{name}/{key}@{each}": value for each, value in variable.attrs.items()})
        return found

    return read


def by_sdf(path: Path) -> Found:
    sdf = pytest.importorskip("sdf")
    found: dict[str, Any] = {}

    def visit(name: str, group: Any) -> None:
        for dataset in group.datasets:
            found[f"{name}/{dataset.name}"] = dataset.data
            found[f"{name}/{dataset.name}@UNIT"] = dataset.unit
        for each in group.groups:
            visit(f"{name}/{each.name}", each)

    visit("", sdf.load(str(path)))
    return found


def by_silx(path: Path) -> Found:
    silx = pytest.importorskip("silx.io")
    from silx.io import nxdata

    found: dict[str, Any] = {}
    with silx.open(str(path)) as file:
        plot = nxdata.get_default(file)  # its labels, as in h5web
        assert plot.signal_name == f"{plot.signal_dataset_name} ({plot.signal.attrs['units']})"
        assert plot.axes_names == ["time (s)"]
        for name, group in file.items():
            for key, item in group.items() if hasattr(group, "items") else ():
                found[f"/{name}/{key}"] = item[()]
                found[f"/{name}/{key}@units"] = item.attrs["units"]
    return found


def by_nexusformat(path: Path) -> Found:
    nexus = pytest.importorskip("nexusformat.nexus")
    tree = nexus.nxload(str(path))
    found: dict[str, Any] = {}
    for name, group in tree.items():
        if not isinstance(group, nexus.NXgroup):
            continue
        if "signal" in group.attrs:  # the default plot
            assert group.nxsignal.nxname == group.attrs["signal"]
            assert [axis.nxname for axis in group.nxaxes] == ["time"]
        for key, field in group.items():
            found[f"/{name}/{key}"] = field.nxdata
            found[f"/{name}/{key}@units"] = field.attrs["units"]
    return found


def by_r(path: Path) -> Found:
    program = """
        package <- Filter(function(name) requireNamespace(name, quietly = TRUE), c("hdf5r", "rhdf5"))[1]
        if (is.na(package)) quit(status = 3)
        path <- commandArgs(TRUE)[1]
        if (package == "hdf5r") {
            file <- hdf5r::H5File$new(path, "r")
            names <- hdf5r::list.datasets(file)
            values <- function(name) file[[name]][]
            units <- function(name) hdf5r::h5attr(file[[name]], "units")
        } else {
            all <- rhdf5::h5ls(path)
            names <- sub("^//", "/", paste(all$group, all$name, sep = "/"))[all$otype == "H5I_DATASET"]
            values <- function(name) rhdf5::h5read(path, name)
            units <- function(name) rhdf5::h5readAttributes(path, name)$units
        }
        for (name in names) cat(name, units(name), sprintf("%.17g", values(name)), "", sep = "\\n")
    """
    said = said_by("Rscript", "-e", program, str(path), lacks=3)
    found: dict[str, Any] = {}
    for name, units, numbers in re.findall(r"^(/?[a-z]\w*(?:/\w+)?)\n(.*)\n((?:[-\dNn].*\n)+)", said, re.M):
        name = f"/{name.lstrip('/')}"
        found |= {name: numbers_of(numbers), f"{name}@units": units}
    return found


def by_ncdump(path: Path) -> Found:
    found: dict[str, Any] = {}
    group = ""
    line = r"^\s*(?:group: (\w+) \{|(\}) // group|string (\w+):(\w+) = \"(.*)\" ;|(\w+) = ([-\d][^;]*) ;)$"
    text = said_by("ncdump", "-p", "9,17", str(path))
    for entered, left, owner, attribute, said, name, numbers in re.findall(line, text, re.M):
        if entered or left:
            group = entered and f"/{entered}"
        elif attribute in ("UNIT", "units"):
            found[f"{group}/{owner}@{attribute}"] = said
        elif len(values := numbers_of(numbers)) > 1:  # not a dimension
            found[f"{group}/{name}"] = values
    return found


def by_h5dump(path: Path) -> Found:
    text = said_by("h5dump", "-y", "-w", "1", "-m", "%.17g", str(path))
    found: dict[str, Any] = {}
    group = ""
    for entered, name, numbers in re.findall(
        r'^ +(?:GROUP "(\w+)"|DATASET "(\w+)" \{\n(?: +DATA(?:TYPE|SPACE) .*\n)+ +DATA \{\n([^}]*))',
        text,
        re.M,
    ):
        group = f"/{entered}" if entered else group
        if name:
            found[f"{group}/{name}"] = numbers_of(numbers)
    return found


def by_octave(path: Path) -> Found:
    program = f"""
        d = load('{path}');
        for [group, name] = d
            if isstruct(group)
                for [values, key] = group
                    printf('/%s/%s', name, key); printf(' %.17g', values); printf('\\n');
                end
            end
        end
    """
    said = [line.split() for line in said_by("octave-cli", "--eval", program).splitlines()]
    return {name: np.array(values, dtype=float) for name, *values in said}


def numbers_of(text: str) -> Any:
    return np.array(text.replace(",", " ").split(), dtype=float)


def said_by(*command: str, lacks: int | None = None) -> str:
    """The output of a command; `lacks` is the status by which it says that it lacks a package of its own."""
    if not shutil.which(command[0]):
        pytest.skip(f"{command[0]} is not installed")
    run = subprocess.run(command, capture_output=True, text=True, timeout=120)
    if run.returncode == lacks:
        pytest.skip(f"{command[0]} lacks its package for HDF5")
    assert run.returncode == 0, run.stderr
    return run.stdout


READERS = {
    "netCDF4": by_netcdf4,
    "xarray-h5netcdf": by_xarray("h5netcdf"),
    "xarray-netcdf4": by_xarray("netcdf4"),
    "SDF": by_sdf,
    "silx": by_silx,
    "nexusformat": by_nexusformat,
    "ncdump": by_ncdump,
    "h5dump": by_h5dump,
    "octave": by_octave,
    "R": by_r,
}
WHOLE = ("netCDF4", "xarray-h5netcdf", "xarray-netcdf4")  # these give all values and attributes


@pytest.mark.parametrize("reader", READERS)
def test_other_programs_read_what_was_written(reader: str, path: Path, written: Found) -> None:
    found = READERS[reader](path)
    values = {name for name in written if "@" not in name and not name.endswith(("/time", "/shaft_angle"))}
    assert values <= found.keys()  # h5dump shows links as such
    if reader in WHOLE:
        assert not found.keys() - written.keys()
        lacking = {name.partition("@")[2] for name in written.keys() - found.keys()}
        assert lacking <= ({"dtype"} if reader.startswith("xarray") else set())  # it makes Booleans of that
    for name, value in found.items():
        np.testing.assert_array_equal(value, written[name], err_msg=name)


def test_a_group_becomes_a_netcdf_file(path: Path, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    belt = xarray.open_dataset(path, group="belt", engine="h5netcdf")
    belt.to_netcdf(tmp_path / "belt.nc", engine="h5netcdf")
    assert xarray.open_dataset(tmp_path / "belt.nc", engine="h5netcdf").identical(belt)


TABLES: dict[str, Callable[[Any, str], dict[str, list[Any]]]] = {
    "pandas": lambda pandas, path: pandas.read_parquet(path).to_dict("list"),
    "polars": lambda polars, path: polars.read_parquet(path).to_dict(as_series=False),
    "duckdb": lambda duckdb, path: {
        name: values.tolist() for name, values in duckdb.sql(f"SELECT * FROM '{path}'").fetchnumpy().items()
    },
}


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> loomfmu.Sweep:
    """A sweep whose second row could not be run, so that it lacks values."""
    folder = tmp_path_factory.mktemp("table")
    scene = (SIMS / "wl680_3600.toml").as_posix()
    text = f'title = "Speeds"\nscene = "{scene}"\nvalues = ["belt.margin", "belt.at_risk"]\n'
    text += '[grid]\n"shaft.speed" = ["600 rpm", "-1 rpm", "700 rpm"]\n[traces]\nfailures = 0\nsample = 0\n'
    (folder / "sweep.toml").write_text(text)
    return loomfmu.sweep(folder / "sweep.toml", processes=1, output=folder / "out")


@pytest.mark.parametrize("reader", TABLES)
def test_other_programs_read_the_table_of_a_sweep(reader: str, swept: loomfmu.Sweep) -> None:
    found = TABLES[reader](pytest.importorskip(reader), str(swept.path))
    expected = swept.table.to_pydict()
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        for value, other in zip(values, found[name], strict=True):
            lacking = other is None or other != other or str(other) in ("<NA>", "--")
            assert lacking if value is None else other == value, name


# A run has no date, and CF wants a time since one; links to one time are one dimension under several names
ACCEPTED = {
    "Dimensions with the same name must be the same object (ID).",
    "time must be in a valid units format <unit> since <epoch> not s",
    "time does not have correct time units",
}


def test_the_cf_checker_finds_no_other_error(path: Path, tmp_path: Path) -> None:
    pytest.importorskip("compliance_checker")
    from compliance_checker.runner import CheckSuite

    named = shutil.copy(path, tmp_path / "trace.nc")
    CheckSuite.load_all_available_checkers()
    suite = CheckSuite()
    results, errors = suite.run_all(suite.load_dataset(str(named)), ["cf:1.11"], [])["cf:1.11"]
    assert not errors
    failed = [each for each in results if each.weight == 3 and each.value[0] < each.value[1]]
    assert {
        message for each in failed for message in each.msgs if "found in same group" not in message
    } <= ACCEPTED
