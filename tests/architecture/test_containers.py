"""What the files in docker/ say of each other and of the code. `docker/verify` runs the image."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

DOCKER = Path(__file__).parents[2] / "docker"
DOCKERFILE = (DOCKER / "Dockerfile").read_text(encoding="utf-8")
COMPOSE = (DOCKER / "compose.yaml").read_text(encoding="utf-8")
SCRIPTS = ("entrypoint", "verify")


def test_every_image_is_pinned_by_an_exact_tag() -> None:
    bases = re.findall(r"^ARG BASE=(\S+)$", DOCKERFILE, re.MULTILINE)
    assert re.fullmatch(r"python:3\.\d+\.\d+-slim-\w+", bases[0])
    assert set(re.findall(r"^FROM (\S+)", DOCKERFILE, re.MULTILINE)) == {"${BASE}"}
    for path in DOCKER.glob("compose*.yaml"):
        for image in re.findall(r"image: (\S+)", path.read_text(encoding="utf-8")):
            assert image == "raysvc" or re.fullmatch(r"\S+:v?\d+\.\d+\.\d+", image)


def test_the_image_does_not_run_as_root_and_can_be_watched_and_stopped() -> None:
    last = DOCKERFILE.rpartition("\nFROM ")[2]
    assert re.findall(r"^USER (\S+)$", last, re.MULTILINE) == ["10001:10001"]
    assert "\nHEALTHCHECK " in last
    assert "\nSTOPSIGNAL SIGTERM\n" in last
    assert "/healthz" in last


def test_what_the_image_writes_to_is_writable_under_a_read_only_root() -> None:
    assert "read_only: true" in COMPOSE
    (data,) = re.findall(r"RAYSVC_DATA_DIR=(\S+)", DOCKERFILE)
    assert f"- data:{data}\n" in COMPOSE
    cache = re.findall(r"RAYSVC_CACHE=(/var\S+)", DOCKERFILE)
    for place in (*cache, "/tmp"):
        assert f"- {place}:size=" in COMPOSE
    assert 'cap_drop: ["ALL"]' in COMPOSE
    assert "no-new-privileges:true" in COMPOSE


def test_everybody_is_let_in_only_where_the_port_is_this_machines() -> None:
    assert "--open" not in re.findall(r"^CMD .*", DOCKERFILE, re.MULTILINE)[-1]
    assert "--open" in COMPOSE
    assert re.findall(r'- "(\S+):8000:8000"', COMPOSE) == ["127.0.0.1"]


@pytest.mark.skipif(shutil.which("sh") is None, reason="there is no shell")
@pytest.mark.parametrize("name", SCRIPTS)
def test_scripts_are_such(name: str) -> None:
    path = DOCKER / name
    assert path.stat().st_mode & 0o111
    subprocess.run(["sh", "-n", str(path)], check=True)


@pytest.mark.skipif(shutil.which("sh") is None, reason="there is no shell")
def test_the_start_copies_kernels_and_says_where_it_cannot(tmp_path: Path) -> None:
    baked = tmp_path / "baked" / "kernels"
    baked.mkdir(parents=True)
    (baked / "one.nbi").write_text("kernel")
    script = tmp_path / "entrypoint"
    text = (DOCKER / "entrypoint").read_text(encoding="utf-8")
    script.write_text(text.replace("/app/kernels", str(tmp_path / "baked")))

    def start(cache: Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["sh", str(script), "echo", "started"],
            env={"RAYSVC_CACHE": str(cache), "PATH": "/usr/bin:/bin"},
            capture_output=True,
            text=True,
            check=False,
        )

    cache = tmp_path / "cache"
    cache.mkdir()
    for _ in range(2):  # a container that is started again finds them there
        done = start(cache)
        assert (done.returncode, done.stdout) == (0, "started\n")
        assert (cache / "kernels" / "one.nbi").read_text() == "kernel"
    done = start(tmp_path / "baked" / "kernels" / "one.nbi")
    assert done.returncode == 1
    assert "mount a tmpfs" in done.stderr
