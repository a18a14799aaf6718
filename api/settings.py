"""What whoever runs the service may choose, through environment variables RAYSVC_..."""

import dataclasses
import os
from pathlib import Path

from pydantic import Field, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from raysvc.errors import InvalidSetting
from raysvc.jobs import ServiceOptions
from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parsing import DEFAULT_OPTIONS, ParserOptions


def default_data_dir() -> Path:
    """Folder for data that a user's programs keep."""
    home = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(home) / "raysvc"


class ApiSettings(BaseSettings):
    """Every field is an environment variable: `queue_size` is RAYSVC_QUEUE_SIZE."""

    model_config = SettingsConfigDict(env_prefix="RAYSVC_", frozen=True)

    data_dir: Path = Field(
        default_factory=default_data_dir,
        description="Where scenes and environments are kept; one process owns it.",
    )
    queue_size: int = Field(
        16, ge=1, le=100_000, description="Jobs that may wait; one more is answered 429."
    )
    kept_jobs: int = Field(
        1_000, ge=1, description="Jobs that are remembered; the oldest finished one goes first."
    )
    deadline_s: float = Field(
        600.0, gt=0, le=86400, description="Time for a job that does not set `deadline_s`."
    )
    wait_max_s: float = Field(
        60.0, ge=0, le=3600, description="Longest wait that `Prefer: wait` is granted."
    )
    grace_s: float = Field(
        20.0, ge=0, le=3600, description="Time for the running job when the service stops."
    )
    heavy_threads: int = Field(
        2, ge=1, le=64, description="Uploads and pictures that are decoded or encoded at a time."
    )
    scene_memory_bytes: int = Field(
        1 << 30, ge=0, description="Parsed scenes that are kept in memory."
    )
    environment_memory_bytes: int = Field(
        512 << 20, ge=0, description="Parsed environments that are kept in memory."
    )
    result_memory_bytes: int = Field(
        512 << 20, ge=0, description="Finished pictures that are kept in memory."
    )
    comparison_memory_bytes: int = Field(
        128 << 20, ge=0, description="Finished comparisons that are kept in memory."
    )
    parse_processes: int = Field(
        DEFAULT_OPTIONS.processes,
        ge=0,
        le=64,
        description="Processes that read uploads; with 0 the service reads them itself, unguarded.",
    )
    parse_uploads: int = Field(
        DEFAULT_OPTIONS.uploads, ge=1, description="Uploads after which such a process is replaced."
    )
    parse_s: float = Field(
        DEFAULT_OPTIONS.seconds, gt=0, le=86400, description="Time to read one upload."
    )
    parse_cpu_s: float = Field(
        DEFAULT_OPTIONS.cpu_seconds,
        gt=0,
        le=86400,
        description="Processor time to read one upload, in whole seconds upwards.",
    )
    parse_memory_bytes: int = Field(
        DEFAULT_OPTIONS.memory_bytes,
        ge=16 << 20,
        le=1 << 44,
        description="Memory to read one upload, what it becomes included.",
    )
    max_json_bytes: int = Field(1 << 20, ge=1, description="Largest JSON body or form field.")
    max_upload_bytes: int = Field(
        DEFAULT_LIMITS.max_scene_bytes,
        ge=1,
        description="Largest upload, all files together, packed and unpacked.",
    )
    max_upload_files: int = Field(
        DEFAULT_LIMITS.max_files, ge=1, le=100_000, description="Files in one upload or archive."
    )
    max_file_bytes: int = Field(
        DEFAULT_LIMITS.max_file_bytes, ge=1, description="One file of an upload, unpacked."
    )
    max_archive_ratio: float = Field(
        DEFAULT_LIMITS.max_archive_ratio, ge=1, description="Unpacked over packed size of a `.zip`."
    )
    max_json_depth: int = Field(
        DEFAULT_LIMITS.max_json_depth, ge=1, le=500, description="Nesting of a glTF document."
    )
    max_nodes: int = Field(
        DEFAULT_LIMITS.max_nodes,
        ge=1,
        description="Nodes of a scene file, and instances that they make.",
    )
    max_node_depth: int = Field(
        DEFAULT_LIMITS.max_node_depth, ge=1, description="Depth of a scene file's hierarchy."
    )
    max_triangles: int = Field(
        DEFAULT_LIMITS.max_triangles, ge=1, description="Triangles of a scene, instances counted."
    )
    max_vertices: int = Field(
        DEFAULT_LIMITS.max_vertices, ge=1, description="Vertices of a scene, instances counted."
    )
    max_materials: int = Field(
        DEFAULT_LIMITS.max_materials, ge=1, description="Materials of a scene."
    )
    max_texture_pixels: int = Field(
        DEFAULT_LIMITS.max_texture_pixels, ge=1, description="Pixels of one texture."
    )
    max_scene_texture_pixels: int = Field(
        DEFAULT_LIMITS.max_scene_texture_pixels,
        ge=1,
        description="Pixels of all textures of a scene.",
    )
    max_environment_pixels: int = Field(
        DEFAULT_LIMITS.max_environment_pixels, ge=1, description="Pixels of an environment."
    )
    max_image_pixels: int = Field(
        DEFAULT_LIMITS.max_image_pixels, ge=1, description="Pixels of a picture."
    )
    max_image_side: int = Field(
        DEFAULT_LIMITS.max_image_side, ge=1, description="Width or height of a picture."
    )
    max_paths: int = Field(
        DEFAULT_LIMITS.max_paths, ge=1, description="Pixels times samples in reference mode."
    )
    max_filtered_texels: int = Field(
        DEFAULT_LIMITS.max_filtered_texels,
        ge=1,
        description="All maps together that an environment is filtered to by one request.",
    )
    max_comparison_rays: int = Field(
        DEFAULT_LIMITS.max_comparison_rays, ge=1, description="Rays of a comparison."
    )
    max_brute_tests: int = Field(
        DEFAULT_LIMITS.max_brute_tests,
        ge=1,
        description="Triangles times rays of a comparison with the structure `brute`.",
    )

    def limits(self) -> Limits:
        """Return the core's limits."""
        same = {
            field.name: getattr(self, field.name)
            for field in dataclasses.fields(Limits)
            if field.name not in ("max_scene_bytes", "max_files")
        }
        return Limits(
            **same | {"max_file_bytes": min(self.max_file_bytes, self.max_upload_bytes)},
            max_scene_bytes=self.max_upload_bytes,
            max_files=self.max_upload_files,
        )

    def parser_options(self) -> ParserOptions:
        """Return what the core's readers of uploads may use."""
        return ParserOptions(
            processes=self.parse_processes,
            seconds=self.parse_s,
            cpu_seconds=self.parse_cpu_s,
            memory_bytes=self.parse_memory_bytes,
            uploads=self.parse_uploads,
        )

    def service_options(self) -> ServiceOptions:
        """Return what the core's service may use."""
        return ServiceOptions(
            data_dir=self.data_dir,
            queue_size=self.queue_size,
            kept_jobs=self.kept_jobs,
            deadline_s=self.deadline_s,
            scene_memory_bytes=self.scene_memory_bytes,
            environment_memory_bytes=self.environment_memory_bytes,
            result_memory_bytes=self.result_memory_bytes,
            comparison_memory_bytes=self.comparison_memory_bytes,
            parsing=self.parser_options(),
            limits=self.limits(),
        )


def settings_from_environment() -> ApiSettings:
    """Read RAYSVC_... variables. Raises InvalidSetting naming the first that is wrong."""
    try:
        return ApiSettings()
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        name = "RAYSVC_" + "_".join(str(part).upper() for part in fault["loc"])
        given = repr(fault["input"])[:80]
        raise InvalidSetting(f"{fault['msg']} (got {given})", field=name) from None
