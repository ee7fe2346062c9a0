"""Sets on disk: the round trip, every way to damage a file, and a run killed while it writes."""

import json
import os
import pickle
import re

import numpy as np
import pytest

from hera_om import surrogates
from hera_om.core.errors import RecordError
from hera_om.surrogates import store

X = np.array([1.7, -6.0])


@pytest.fixture
def file(small, tmp_path):
    return surrogates.save(small, tmp_path / "aero.npz")


def rewrite(file, change):
    """The file with its header and arrays changed by hand."""
    with np.load(file) as archive:
        content = {key: archive[key] for key in archive.files}
    header = json.loads(content["header"].tobytes())
    change(header, content)
    if "header" in content:
        content["header"] = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    np.savez(file, **content)


def test_round_trip_to_the_last_bit(small, file):
    again = surrogates.load(file)
    assert np.array_equal(again.evaluate(X), small.evaluate(X))
    assert np.array_equal(again.jacobian(X), small.jacobian(X))
    assert again.table() == small.table()
    for name in ("input_names", "input_units", "output_names", "output_units", "output_sizes", "kinds"):
        assert getattr(again, name) == getattr(small, name)
    assert (again.seed, again.definition_hash, again.versions) == (3, "abc123", small.versions)
    assert {"numpy", "scipy", "smt", "jax"} <= set(again.versions)
    assert all(np.array_equal(a, b) for a, b in zip(again.samples, small.samples, strict=True))


def test_folder_is_made_and_the_file_named(small, tmp_path):
    file = surrogates.save(small, tmp_path / "new" / "runs")
    assert file == tmp_path / "new" / "runs" / "surrogates.npz"
    assert surrogates.load(tmp_path / "new" / "runs").kinds == small.kinds


def test_file_is_plain_arrays_and_json(file):
    with np.load(file, allow_pickle=False) as archive:
        header = json.loads(archive["header"].tobytes())
        assert all(archive[key].dtype == np.float64 for key in archive.files if key != "header")
    assert header["input_units"] == ["deg", "deg"] and header["lower"] == [-4.0, -20.0]


def test_every_cut_is_noticed(file):
    whole = file.read_bytes()
    for length in (0, 1, 3, 4, 100, len(whole) // 3, len(whole) // 2, len(whole) - 30, len(whole) - 1):
        file.write_bytes(whole[:length])
        with pytest.raises(RecordError, match=re.escape(str(file))):
            surrogates.load(file)


def test_every_flipped_byte_is_noticed_or_harmless(small, file):
    """A byte may stand in padding or a time stamp of the archive; then the set must still be the same."""
    whole = file.read_bytes()
    noticed = 0
    for place in np.random.default_rng(0).integers(0, len(whole), 150):
        damaged = bytearray(whole)
        damaged[place] ^= 0x55
        file.write_bytes(damaged)
        try:
            again = surrogates.load(file)
        except RecordError as error:
            noticed += 1
            assert str(file) in str(error)
        else:
            assert np.array_equal(again.evaluate(X), small.evaluate(X))
    assert noticed > 100


def forget(key):
    return lambda header, content: content.pop(key)


def spoil(key, value):
    return lambda header, content: content.update({key: value})


def edit(**changes):
    return lambda header, content: header.update(changes)


def poison(header, content):
    content["kriging.weights"] = content["kriging.weights"] * np.nan


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (edit(version=2), "format version 2"),
        (edit(format="something else"), "is not a file of surrogates"),
        (edit(input_names=["alpha"]), "input_units has 2 entries, not 1"),
        (edit(input_names=["alpha"], input_units=["deg"]), "not float64 of (1,)"),
        (edit(output_sizes=[1, 1, 1, 1, 6]), "predictor.offset"),
        (edit(kinds=["rbf", "rbf", "constant", "rbf", "spline"]), "spline"),
        (edit(quality=[{}] * 5), "quality of a chosen model is missing"),
        (edit(quality=[]), "shorter"),
        (edit(lower=[-5.0, -20.0]), "lower differs"),
        (edit(output_sizes=None), "NoneType"),
        (forget("header"), "header is missing"),
        (forget("kriging.theta"), "kriging.theta is missing"),
        (forget("samples.y"), "samples.y is missing"),
        (spoil("rbf.width", np.ones(9)), "rbf.width"),
        (spoil("predictor.lower", np.array([-4, -20])), "int64"),
        (poison, "kriging.weights holds a number that is not finite"),
    ],
)
def test_file_that_does_not_agree_with_itself(file, change, reason):
    rewrite(file, change)
    with pytest.raises(RecordError) as caught:
        surrogates.load(file)
    assert str(file) in str(caught.value) and reason in str(caught.value)


def test_pickles_are_never_loaded(file, tmp_path):
    class Trap:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "sprung"),)

    rewrite(file, spoil("rbf.width", np.array([Trap()], dtype=object)))
    with pytest.raises(RecordError):
        surrogates.load(file)
    file.write_bytes(pickle.dumps(Trap()))
    with pytest.raises(RecordError):
        surrogates.load(file)
    assert not (tmp_path / "sprung").exists()


@pytest.mark.parametrize("content", [b"", b"not an archive", b"PK\x03\x04 neither"])
def test_another_file_is_refused(tmp_path, content):
    (tmp_path / "aero.npz").write_bytes(content)
    with pytest.raises(RecordError, match=r"aero\.npz"):
        surrogates.load(tmp_path / "aero.npz")


def test_bare_array_missing_file_and_folder_are_refused(tmp_path):
    with open(tmp_path / "bare.npz", "wb") as stream:
        np.save(stream, np.ones(3))
    (tmp_path / "folder.npz").mkdir()
    for name in ("bare.npz", "missing.npz", "folder.npz", "nowhere"):
        with pytest.raises(RecordError, match=name):
            surrogates.load(tmp_path / name)


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_interrupted_write_leaves_the_old_file(small, file, monkeypatch, step):
    before = file.read_bytes()

    def interrupt(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(store.os, step, interrupt)
    with pytest.raises(KeyboardInterrupt):
        surrogates.save(small, file)
    assert file.read_bytes() == before
    assert list(file.parent.iterdir()) == [file]


def test_second_write_replaces_the_first(small, file):
    before = file.read_bytes()
    surrogates.save(small, file)
    with np.load(file) as archive:
        assert len(before) == file.stat().st_size and "header" in archive.files
