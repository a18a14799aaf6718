"""Files read by other processes: the same scenes and errors as in this one, whatever they do to
their reader."""

import errno
import io
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from raysvc.errors import InvalidInput, InvalidScene, LimitExceeded, RaysvcError
from raysvc.limits import Limits
from raysvc.loading.picture_file import read_depth, read_picture
from raysvc.loading.shape_file import read_shape
from raysvc.parsing import Parser, ParserOptions
from raysvc.parsing import launcher as launcher_module
from raysvc.parsing import parser_process as process_module
from raysvc.parsing.tasks import read_environment, read_scene
from tests.api.glb import glb

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs rlimits")

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture(scope="module")
def parser() -> Iterator[Parser]:
    parser = Parser(ParserOptions(processes=1))
    yield parser
    parser.close()


def strict(**options: float) -> Parser:
    return Parser(ParserOptions(processes=1, **options))  # type: ignore[arg-type]


def slow_ply(vertices: int) -> bytes:
    """A text that takes a while to read: a million numbers a second or two."""
    rows = "".join(f"{i % 97}.25 {i % 89}.5 {i % 83}.125\n" for i in range(vertices))
    faces = "".join(f"3 {i} {i + 1} {i + 2}\n" for i in range(vertices - 2))
    return (
        f"ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {vertices - 2}\n"
        f"property list uchar int vertex_indices\nend_header\n{rows}{faces}"
    ).encode()


def hdr(width: int, height: int) -> bytes:
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    return head + bytes([128, 64, 32, 129]) * (width * height)


def ids(parser: Parser) -> list[int]:
    return [process.id for process in parser._idle]


def test_a_scene_is_the_same_as_when_it_is_read_here(parser: Parser) -> None:
    files = {"a.glb": glb()}
    here, there = read_scene(files, None, Limits()), parser.scene(files)
    for name in ("positions", "normals", "tangents", "uv", "colours", "triangles"):
        assert np.array_equal(getattr(here, name), getattr(there, name))
    assert here.materials == there.materials
    assert (here.name, here.warnings) == (there.name, there.warnings)


def test_an_environment_is_the_same_as_when_it_is_read_here(parser: Parser) -> None:
    files = {"sky.hdr": hdr(8, 4)}
    here, there = read_environment(files, Limits()), parser.environment(files)
    assert np.array_equal(here.radiance, there.radiance)
    assert here.name == there.name == "sky"


@pytest.mark.parametrize(
    ("files", "main"),
    [
        ({"a.obj": b""}, None),
        ({"a.gltf": b"{"}, None),
        ({"a.obj": OBJ, "b.obj": OBJ}, None),
        ({"a.obj": OBJ, "b.obj": OBJ}, "c.obj"),
        ({"../a.obj": OBJ}, None),
        ({"a.zip": b"PK\3\4 broken"}, None),
        ({}, None),
    ],
)
def test_an_error_is_the_same_as_when_it_is_found_here(
    parser: Parser, files: dict[str, bytes], main: str | None
) -> None:
    with pytest.raises(InvalidInput) as here:
        read_scene(files, main, Limits())
    with pytest.raises(InvalidInput) as there:
        parser.scene(files, main)
    assert type(there.value) is type(here.value)
    assert (there.value.message, there.value.field) == (here.value.message, here.value.field)


def test_a_picture_its_depth_and_a_shape_are_the_same_as_when_they_are_read_here(
    parser: Parser,
) -> None:
    file = io.BytesIO()
    rgba = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    np.savez(file, beauty=rgba, depth=1 + rgba[..., 0])
    picture, depth = file.getvalue(), parser.depth(file.getvalue(), None)
    assert np.array_equal(parser.picture(picture).rgba, read_picture(picture).rgba)
    assert np.array_equal(depth, read_depth(picture))
    for dtype in (np.float32, np.float64, np.int16):
        file = io.BytesIO()
        np.savez(file, positions=np.arange(6, dtype=dtype).reshape(2, 3), normals=np.ones((2, 3)))
        here, there = read_shape(file.getvalue(), 2), parser.shape(file.getvalue(), 2)
        assert np.array_equal(here.positions, there.positions)
        assert here.normals is not None and there.normals is not None
        assert np.array_equal(here.normals, there.normals)
    with pytest.raises(InvalidInput, match="is missing from the archive"):
        file = io.BytesIO()
        np.savez(file, normals=np.ones((2, 3)))
        parser.shape(file.getvalue(), 2)
    with pytest.raises(InvalidInput) as refused:
        parser.picture(b"GIF89a")
    assert refused.value.field == "picture"


def test_a_file_that_takes_too_long_is_refused_and_the_next_is_read() -> None:
    parser = strict(seconds=0.4)
    try:
        with pytest.raises(LimitExceeded, match="RAYSVC_PARSE_S") as refused:
            parser.scene({"slow.ply": slow_ply(300_000)})
        assert refused.value.field == "slow.ply"
        assert len(parser.scene({"a.obj": OBJ}).triangles) == 1
    finally:
        parser.close()


def test_a_file_that_takes_too_much_of_a_processor_is_refused() -> None:
    parser = strict(seconds=60.0, cpu_seconds=0.1)
    try:
        with pytest.raises(LimitExceeded, match="RAYSVC_PARSE_CPU_S"):
            parser.scene({"slow.ply": slow_ply(500_000)})
    finally:
        parser.close()


def test_a_file_that_takes_too_much_memory_is_refused_and_the_next_is_read() -> None:
    parser = strict(memory_bytes=32 << 20)
    try:
        with pytest.raises(LimitExceeded, match=r"32 MiB.*RAYSVC_PARSE_MEMORY_BYTES"):
            parser.environment({"large.hdr": hdr(2048, 1024)})
        assert parser.environment({"small.hdr": hdr(8, 4)}).radiance.shape == (4, 8, 3)
    finally:
        parser.close()


def test_a_file_that_kills_its_reader_is_refused_and_the_next_is_read() -> None:
    parser = strict()
    try:
        parser.scene({"a.obj": OBJ})
        (victim,) = ids(parser)
        slow = slow_ply(300_000)
        threading.Timer(0.5, os.kill, (victim, signal.SIGSEGV)).start()
        with pytest.raises(InvalidScene, match=r"breaks what reads it \(SIGSEGV\)"):
            parser.scene({"slow.ply": slow})
        assert len(parser.scene({"a.obj": OBJ}).triangles) == 1
        assert ids(parser) != [victim]
    finally:
        parser.close()


def test_a_reader_that_died_in_its_sleep_is_replaced_unnoticed(parser: Parser) -> None:
    parser.scene({"a.obj": OBJ})
    (victim,) = ids(parser)
    os.kill(victim, signal.SIGKILL)
    time.sleep(0.1)
    assert len(parser.scene({"a.obj": OBJ}).triangles) == 1
    assert ids(parser) != [victim]


def test_a_reader_ends_after_so_many_uploads() -> None:
    parser = strict(uploads=2)
    try:
        seen = []
        for _ in range(4):
            parser.scene({"a.obj": OBJ})
            seen += ids(parser)
        assert seen[0] != seen[1] == seen[2] != seen[3]
    finally:
        parser.close()


def test_a_reader_that_has_grown_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    parser = strict()
    try:
        parser.scene({"a.obj": OBJ})
        before = ids(parser)
        monkeypatch.setattr(process_module, "GROWTH_BYTES", -1)
        parser.scene({"a.obj": OBJ})
        assert ids(parser) != before
    finally:
        parser.close()


def test_many_threads_share_a_few_readers() -> None:
    parser = Parser(ParserOptions(processes=2))
    try:
        with ThreadPoolExecutor(8) as pool:
            files = [{f"{n}.obj": OBJ} for n in range(24)]
            scenes = list(pool.map(parser.scene, files))
        assert sorted(int(scene.name) for scene in scenes) == list(range(24))
        assert len(parser._idle) == 2
    finally:
        parser.close()


def test_a_launcher_that_never_starts_is_our_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(launcher_module, "_START", "raise SystemExit(3)")
    parser = strict()
    try:
        with pytest.raises(RaysvcError, match=r"does not start \(exit code 3\)") as failed:
            parser.scene({"a.obj": OBJ})
        assert not isinstance(failed.value, InvalidInput)
    finally:
        parser.close()


def test_a_launcher_that_died_is_replaced_unnoticed() -> None:
    parser = strict(uploads=1)
    try:
        parser.scene({"a.obj": OBJ})
        assert parser._launcher is not None
        victim = parser._launcher.id
        os.kill(victim, signal.SIGKILL)
        for _ in range(3):
            assert len(parser.scene({"a.obj": OBJ}).triangles) == 1
        assert parser._launcher.id != victim
    finally:
        parser.close()


def test_a_reader_is_told_nothing_that_it_need_not_know(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RAYSVC_TEST_SECRET", "hush")
    monkeypatch.setenv("LC_TEST", "C")
    parser = strict()
    try:
        parser.scene({"a.obj": OBJ})
        told = Path(f"/proc/{ids(parser)[0]}/environ").read_bytes().split(b"\0")
        names = {entry.partition(b"=")[0].decode() for entry in told if entry}
        assert {"PATH", "LC_TEST", "OMP_NUM_THREADS", "PYTHONPATH"} <= names
        assert "RAYSVC_TEST_SECRET" not in names
    finally:
        parser.close()


def test_a_reader_that_may_make_no_files_reads_what_needs_one(parser: Parser) -> None:
    for radiance in (0.5, 0.25):
        dark = hdr(8, 4).replace(
            bytes([128, 64, 32, 129]), bytes([int(radiance * 256)] * 3 + [128])
        )
        assert np.allclose(parser.environment({"sky.hdr": dark}).radiance, radiance, atol=0.01)


def test_nothing_is_left_behind(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    before = len(os.listdir("/proc/self/fd"))
    parser = strict(seconds=0.3)
    with pytest.raises(LimitExceeded):
        parser.scene({"slow.ply": slow_ply(200_000)})
    parser.environment({"sky.hdr": hdr(8, 4)})
    assert parser._launcher is not None
    started = [*ids(parser), parser._launcher.id]
    parser.close()
    assert os.listdir(tmp_path) == []
    assert len(os.listdir("/proc/self/fd")) == before
    for process in started:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_all_ends_with_the_service(tmp_path: Path) -> None:
    code = f"""
import os, tempfile, time
tempfile.tempdir = {str(tmp_path)!r}
from raysvc.parsing import Parser, ParserOptions
parser = Parser(ParserOptions(processes=1))
parser.scene({{"a.obj": {OBJ!r}}})
print(parser._launcher.id, parser._idle[0].id, flush=True)
time.sleep(60)
"""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as service:
        assert service.stdout is not None
        left = [int(id) for id in service.stdout.readline().split()]
        assert len(left) == 2
        service.kill()
    end = time.monotonic() + 10
    while any(is_running(id) for id in left) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(is_running(id) for id in left)
    assert os.listdir(tmp_path) == []


def test_what_outlives_a_killed_service_says_nothing(tmp_path: Path) -> None:
    code = f"""
import os, signal, threading
from raysvc.parsing import Parser, ParserOptions
parser = Parser(ParserOptions(processes=1, uploads=1))
parser.scene({{"a.obj": {OBJ!r}}})
launcher = parser._launcher
os.kill(launcher.id, signal.SIGSTOP)
launcher._socket.sendall(b'{{"reap": %d}}' % launcher.id)  # answered when nobody listens
threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGKILL)).start()
print(launcher.id, flush=True)
signal.pause()
"""
    said = tmp_path / "said.txt"
    with said.open("wb") as file:
        service = subprocess.Popen(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=file
        )
        with service:
            assert service.stdout is not None
            left = int(service.stdout.readline())
        os.kill(left, signal.SIGCONT)
        end = time.monotonic() + 10
        while is_running(left) and time.monotonic() < end:
            time.sleep(0.05)
    assert not is_running(left)
    assert said.read_text() == ""


def is_running(id: int) -> bool:
    """Is there such a process, and is it more than a remainder that nobody asks for?"""
    try:
        return ") Z " not in Path(f"/proc/{id}/stat").read_text()
    except FileNotFoundError:
        return False


def test_a_full_disk_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    def full() -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    parser = strict()
    try:
        with monkeypatch.context() as patched:
            patched.setattr(process_module, "_anonymous_file", full)
            for _ in range(3):
                with pytest.raises(OSError, match="No space"):
                    parser.scene({"a.obj": OBJ})
        assert len(parser.scene({"a.obj": OBJ}).triangles) == 1
    finally:
        parser.close()


def test_after_its_end_nothing_is_read() -> None:
    parser = strict()
    parser.close()
    with pytest.raises(RaysvcError, match="shutting down"):
        parser.scene({"a.obj": OBJ})
