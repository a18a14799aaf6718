"""Where compiled kernels are kept."""

import os
import stat
from pathlib import Path

import numba
import numpy as np
import pytest

from raysvc import jit
from raysvc.jit import inlined, inlined_allocating, kernel, kernel_cache_dir, source_hash


@pytest.fixture
def clean(monkeypatch, tmp_path):
    """No choice made: an empty home, and a temporary folder that is the test's own."""
    monkeypatch.delenv("RAYSVC_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    (tmp_path / "home").mkdir()
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr(jit.tempfile, "tempdir", str(tmp_path / "tmp"))
    return tmp_path


def test_the_folder_is_named_after_the_sources(clean):
    assert kernel_cache_dir().name == source_hash()
    assert len(source_hash()) == 16
    assert source_hash() == source_hash()


def test_a_chosen_folder_comes_first(clean, monkeypatch):
    monkeypatch.setenv("RAYSVC_CACHE", str(clean / "chosen"))
    assert kernel_cache_dir() == clean / "chosen" / "kernels" / source_hash()


def test_then_the_users_cache(clean, monkeypatch):
    assert kernel_cache_dir().is_relative_to(clean / "home" / ".cache" / "raysvc")
    monkeypatch.setenv("XDG_CACHE_HOME", str(clean / "xdg"))
    assert kernel_cache_dir().is_relative_to(clean / "xdg" / "raysvc")


def test_the_folder_is_private_to_its_user(clean):
    assert stat.S_IMODE(kernel_cache_dir().stat().st_mode) == 0o700


def block(path):
    """Make it impossible to create folders below, also for root."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("in the way")


def test_without_a_writable_home_a_temporary_folder_serves(clean):
    block(clean / "home" / ".cache")
    assert kernel_cache_dir().is_relative_to(clean / "tmp")


def test_if_nothing_else_is_left_the_folder_is_new(clean, monkeypatch):
    monkeypatch.setenv("RAYSVC_CACHE", str(clean / "chosen"))
    block(clean / "chosen")
    first, second = kernel_cache_dir(), kernel_cache_dir()
    assert first.is_dir()
    assert first != second


def test_a_user_without_a_home_can_run(clean, monkeypatch):
    def nowhere():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", nowhere)
    assert kernel_cache_dir().is_relative_to(clean / "tmp")


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="there are no owners of files")
def test_a_temporary_folder_that_others_can_write_is_not_trusted(clean):
    # Compiled kernels are code: whoever can put files there would run theirs as us.
    block(clean / "home" / ".cache")
    planted = clean / "tmp" / f"raysvc-{os.getuid()}"
    planted.mkdir()
    planted.chmod(0o777)
    assert not kernel_cache_dir().is_relative_to(planted)


def test_kernels_loop_and_divide_like_numpy():
    assert reciprocals.targetoptions["nogil"]
    out = np.empty(3)
    reciprocals(np.array([2.0, 0.0, -0.0]), out)
    assert out.tolist() == [0.5, np.inf, -np.inf]


@inlined
def reciprocal(x):
    return 1.0 / x


@kernel
def reciprocals(x, out):
    for k in range(len(x)):
        out[k] = reciprocal(x[k])


def test_what_is_inlined_makes_arrays_only_if_it_says_so():
    out = np.zeros(3)
    write_doubled(np.array([1.0, 2.0, 3.0]), out)
    assert out.tolist() == [2, 4, 6]
    with pytest.raises(numba.TypingError):
        room()


@inlined
def room():
    return np.empty(3)


@inlined_allocating
def doubled(x):
    out = np.empty_like(x)
    for k in range(len(x)):
        out[k] = 2.0 * x[k]
    return out


@kernel
def write_doubled(x, out):
    more = doubled(x)
    for k in range(len(x)):
        out[k] = more[k]
