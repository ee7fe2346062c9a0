"""Programs kept on disk: found again, told apart, made anew when damaged."""

import pickle
import threading

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.core import programs
from hera_om.core.precision import enable

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
    enable()  # JAX's own cache too
    TRACED.clear()
    return tmp_path / "programs"


def call(factor=3.0, pair=PAIR):
    """A new wrapper, as in a new process."""
    return programs.Program(stage, 1)(factor, pair)


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


def test_damaged_code_is_made_anew(folder):
    call()
    (file,) = folder.iterdir()
    *rest, code = pickle.loads(file.read_bytes())
    file.write_bytes(pickle.dumps((*rest, code[: len(code) // 2])))
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])
    call()
    assert TRACED == [3.0, 3.0]


def test_code_compiled_twice_can_be_kept(folder):
    """JAX's own cache hands the second compilation code that has lost its symbols when it is written again."""
    for _ in range(2):
        call()
        (file,) = folder.iterdir()
        file.unlink()
    call()
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])


def test_begun_by_shapes_and_called_with_arrays(folder):
    """What was begun is what the call waits for, whoever asks first and from whatever thread."""
    program = programs.Program(stage, 1)
    pair = jax.tree.map(lambda v: jax.ShapeDtypeStruct(v.shape, v.dtype), PAIR)
    shapes = program.begin(3.0, pair)
    assert {name: v.shape for name, v in shapes.items()} == {"x": (2,), "trace": ()}
    found = []
    threads = [threading.Thread(target=lambda: found.append(program(3.0, PAIR)["x"])) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    np.testing.assert_allclose(found, [[1.5, 3.0]] * 3)
    assert TRACED == [3.0] and not programs.busy()
    assert programs.Program(stage, 1).begin(3.0, pair) == shapes and TRACED == [3.0]


def test_what_fails_fails_again_for_who_asks(folder):
    program = programs.Program(stage, 1)
    with pytest.raises(ValueError, match="core dimension"):
        program.begin(3.0, (np.ones((2, 3)), np.ones(2)))
    with pytest.raises(ValueError, match="core dimension"):
        program(3.0, (np.ones((2, 3)), np.ones(2)))


def test_an_option_that_xla_does_not_know_is_left_out(folder):
    program = programs.Program(stage, 1, {"xla_no_such_option": True} | programs.FAST)
    np.testing.assert_allclose(program(3.0, PAIR)["x"], [1.5, 3.0])
    assert programs._known((("xla_no_such_option", True), *programs.FAST.items())) == programs.FAST


def test_a_folder_that_cannot_be_written_costs_only_time(folder):
    folder.parent.joinpath("programs").write_text("a file in its place")
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])


def test_without_being_told_nothing_is_kept(folder, monkeypatch):
    monkeypatch.setattr(programs, "_kept", False)
    np.testing.assert_allclose(call()["x"], [1.5, 3.0])
    assert not folder.exists()
