"""Stage times of a warm frame: `python -m bench.frame [SCENE [WIDTHxHEIGHT]]`, median of five."""

import statistics
import sys

import raysvc

ROUNDS = 5


def main(source: str = "builtin:torus_park", size: str = "1280x720") -> None:
    """Render once to warm up, then five times, and print a Markdown table."""
    scene = raysvc.load(source)
    width, height = (int(number) for number in size.split("x"))
    view: dict[str, object] = {"width": width, "height": height}
    if scene.cameras:
        view["gltf_camera"] = 0
    raysvc.render(scene, camera=view)
    frames = [raysvc.render(scene, camera=view).statistics for _ in range(ROUNDS)]
    rows = [
        (stage.name, [each.stages[i].seconds for each in frames])
        for i, stage in enumerate(frames[0].stages)
    ]
    rows.append(("total", [each.total_seconds for each in frames]))
    lines = ["| stage | seconds |", "|---|---|"]
    lines += [f"| {name} | {statistics.median(seconds):.3f} |" for name, seconds in rows]
    first = frames[0]
    lines += [
        "",
        f"{first.threads} threads; {first.edge_fraction:.1%} edge pixels; rays {first.rays}",
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
