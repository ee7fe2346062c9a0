"""Programs kept on disk: found again, told apart, made anew when damaged."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.core import programs

TRACED = []


def stage(factor, pair):
    """A stage with one static argument that calls LAPACK."""
    TRACED.append(factor)
    matrix, right = pair
    return {"x": factor * jnp.linalg.solve(matrix, right), "trace": jnp.trace(matrix)}


PAIR = (np.array([[2.0, 1.0], [0.0, 4.0]]), np.array([2.0, 4.0]))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A cache folder of its own, in a process that keeps programs."""
    monkeypatch.setenv("HERA_OM_CACHE", str(tmp_path))
    monkeypatch.setattr(programs, "_kept", True)
    TRACED.clear()
    return tmp_path / "programs"


def call(factor=3.0, pair=PAIR):
    """A new wrapper, as in a new process."""
    return programs.program(stage, 1)(factor, pair)


def test_a_kept_program_is_not_traced_again(folder):
    first, second = call(), call()
    assert TRACED == [3.0] and len(list(folder.iterdir())) == 1
    np.testing.assert_array_equal(first["x"], second["x"])
    np.testing.assert_allclose(second["x"], [1.5, 3.0])
    assert float(second["trace"]) == 6.0


def test_other_statics_and_shapes_are_other_programs(folder):
    call()
    np.testing.assert_allclose(call(factor=5.0)["x"], [2.5, 5.0])
    np.testing.assert_allclose(call(pair=(np.eye(3), np.ones(3)))["x"], 3.0)
    assert TRACED == [3.0, 5.0, 3.0] and len(list(folder.iterdir())) == 3


def test_another_source_is_another_program(folder, monkeypatch):
    call()
    monkeypatch.setattr(programs, "_source", lambda: "changed")
    call()
    assert TRACED == [3.0, 3.0]


@pytest.mark.parametrize("text", [b"", b"nonsense", b"\x80\x04K\x01."])
def test_a_damaged_file_is_made_anew(folder, text):
    call()
    (file,) = folder.iterdir()
    file.write_bytes(text)
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])
    assert TRACED == [3.0, 3.0]
    call()
    assert TRACED == [3.0, 3.0]


def test_a_folder_that_cannot_be_written_costs_only_time(folder):
    folder.parent.joinpath("programs").write_text("a file in its place")
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])


def test_without_being_told_nothing_is_kept(folder, monkeypatch):
    monkeypatch.setattr(programs, "_kept", False)
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])
    assert not folder.exists()
