"""How large input may be before it is refused, said once and with defaults that fit a 4 GB
container."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """Upper bounds; every one is checked before the memory that it guards is asked for."""

    max_file_bytes: int = 512 << 20
    """One file of a scene or environment."""
    max_scene_bytes: int = 1 << 30
    """All files of one scene together, after an archive is unpacked."""
    max_files: int = 1_000
    """Files of one scene."""
    max_archive_ratio: float = 200.0
    """Unpacked over packed size of an archive."""
    max_json_depth: int = 64
    """Nesting of a glTF document."""
    max_nodes: int = 100_000
    """Nodes of a glTF document, and instances that its hierarchy makes."""
    max_node_depth: int = 1_000
    """Depth of a glTF node hierarchy."""
    max_triangles: int = 20_000_000
    """Triangles of a scene, instances counted."""
    max_vertices: int = 40_000_000
    """Vertices of a scene, instances counted."""
    max_materials: int = 10_000
    """Materials of a scene."""
    max_texture_pixels: int = 8192 * 8192
    """One texture."""
    max_scene_texture_pixels: int = 256 << 20
    """All textures of a scene."""
    max_environment_pixels: int = 8192 * 4096
    """An environment map."""
    max_image_pixels: int = 7680 * 4320
    """A picture to render."""
    max_image_side: int = 8192
    """Width or height of a picture to render."""
    max_paths: int = 1 << 32
    """Pixels times samples of a picture in reference mode."""
    max_render_core_s: float = 3600.0
    """Estimated seconds of one processor for a picture (`raysvc.frame.cost`)."""
    max_filtered_texels: int = 1 << 20
    """All maps together that an environment is filtered to at once."""
    max_comparison_rays: int = 10_000_000
    """Rays with which structures are compared."""
    max_brute_tests: int = 200_000_000
    """Triangles times rays of a comparison in which the structure `brute` takes part."""


DEFAULT_LIMITS = Limits()
