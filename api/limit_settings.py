"""The part of the settings that says what is too much: of an upload, and of what is asked for.

Every limit of the core is a setting here, and nothing that a caller sends is without one.
"""

import dataclasses

from pydantic import Field
from pydantic_settings import BaseSettings

from raysvc.limits import DEFAULT_LIMITS, Limits
from raysvc.parsing import DEFAULT_OPTIONS, ParserOptions


class LimitSettings(BaseSettings):
    """Limits on uploads, and on the processes that read them, and on requests."""

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
    max_render_core_s: float = Field(
        DEFAULT_LIMITS.max_render_core_s,
        gt=0,
        description="Estimated seconds of one processor for a picture.",
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
