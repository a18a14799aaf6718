"""Rays through scenes of solid, cut-out and see-through materials, against lists made by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from raysvc.scene import Material
from raysvc.shading.scene_tables import SceneTables
from raysvc.tracing.world import World
from tests.oracles.layers import layers
from tests.scenes import joined, masked_quad, mesh, quad, rays, soup

SEEDS = st.integers(0, 2**32 - 1)


def alpha(value, mode, double_sided=True):
    return Material(
        base_colour=(1, 1, 1, value), alpha_mode=mode, double_sided=double_sided, metallic=0.0
    )


MIXED = (
    alpha(0.2, "opaque"),
    alpha(0.2, "opaque", double_sided=False),
    alpha(0.9, "mask"),
    alpha(0.1, "mask"),
    alpha(0.3, "blend"),
    alpha(0.8, "blend", double_sided=False),
    alpha(0.0, "blend"),
)
COVERAGE = (1.0, 1.0, 1.0, 0.0, 0.3, 0.8, 0.0)


def world(scene, structure="auto"):
    return World(scene, SceneTables.of(scene), structure)


def mixed_scene(rng, count=80, solid=True):
    positions, triangles = soup(rng, count, size=0.6)
    return mesh(
        positions,
        triangles,
        materials=MIXED,
        material_of_triangle=rng.integers(0 if solid else 2, len(MIXED), count),
    )


def random_rays(rng, count=80, t_max=np.inf):
    return rays(rng.uniform(-1.5, 1.5, (count, 3)), rng.normal(size=(count, 3)), t_max)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.booleans(), st.sampled_from([np.inf, 0.7]))
def test_rays_through_mixed_scenes_meet_what_the_slow_list_says(seed, solid, t_max):
    rng = np.random.default_rng(seed)
    scene, asked = mixed_scene(rng, solid=solid), random_rays(rng, t_max=t_max)
    found, sure = layers(scene, COVERAGE, asked)
    assert sure.mean() > 0.4
    through_all = world(scene)
    hits = through_all.nearest(asked)
    through = through_all.transmittance(asked)
    hiding, hidden = through_all.hiding(asked)
    ray, seen = through_all.along(asked)
    assert (np.diff(ray) >= 0).all()
    for r in np.flatnonzero(sure):
        stops = [(t, f) for t, f, a, _ in found[r] if a >= 0.5]
        t, triangle = stops[0] if stops else (np.inf, -1)
        assert hits.triangle[r] == triangle
        assert hits.t[r] == pytest.approx(t, rel=1e-4)
        assert through[r] == pytest.approx(np.prod([1 - a for _, _, a, _ in found[r]]), abs=1e-5)

        shares, left = [], 1.0
        for t, f, a, _ in found[r]:
            shares.append((left * a, t, f))
            left *= 1 - a
        assert hidden[r] == pytest.approx(left, abs=1e-5)
        shares.sort(reverse=True)
        if not shares or shares[0][0] == 0:
            assert hiding.triangle[r] == -1 and hiding.t[r] == np.inf
        elif len(shares) == 1 or shares[0][0] > shares[1][0] + 1e-5:
            assert hiding.triangle[r] == shares[0][2]
            assert hiding.t[r] == pytest.approx(shares[0][1], rel=1e-4)

        expected = []
        for t, f, a, behind in found[r]:
            if a > 0 and not (behind and not MIXED[scene.material_of_triangle[f]].double_sided):
                expected.append((t, f))
                if a == 1:
                    break
        at = ray == r
        assert seen.triangle[at].tolist() == [f for _, f in expected]
        assert seen.t[at] == pytest.approx([t for t, _ in expected], rel=1e-4)


@settings(deadline=None, max_examples=25)
@given(SEEDS, st.booleans(), st.sampled_from([np.inf, 0.7]), st.booleans())
def test_drawn_hits_are_those_that_cover_more_than_a_share(seed, solid, t_max, from_camera):
    rng = np.random.default_rng(seed)
    scene, asked = mixed_scene(rng, solid=solid), random_rays(rng, t_max=t_max)
    found, sure = layers(scene, COVERAGE, asked)
    share = rng.random(len(asked))
    hits = world(scene).drawn(asked, share, from_camera=from_camera)
    for r in np.flatnonzero(sure):
        through, expected = 1.0, (np.inf, -1)
        for t, f, a, behind in found[r]:
            double_sided = MIXED[scene.material_of_triangle[f]].double_sided
            through *= 1.0 if from_camera and behind and not double_sided else 1.0 - a
            if 1.0 - through > share[r]:
                expected = (t, f)
                break
        assert hits.triangle[r] == expected[1]
        assert hits.t[r] == pytest.approx(expected[0], rel=1e-4)


def test_structures_agree_on_mixed_scenes(rng):
    scene, asked = mixed_scene(rng), random_rays(rng, 300)
    one, other = world(scene, "brute"), world(scene)
    assert (one.nearest(asked).triangle == other.nearest(asked).triangle).mean() > 0.99
    assert one.transmittance(asked) == pytest.approx(other.transmittance(asked), abs=1e-5)


def test_an_empty_scene_lets_everything_through(rng):
    empty = world(mesh(np.zeros((0, 3)), np.zeros((0, 3))))
    asked = random_rays(rng, 5)
    assert (empty.nearest(asked).triangle == -1).all()
    assert (empty.transmittance(asked) == 1).all()
    assert (empty.drawn(asked, np.zeros(5)).triangle == -1).all()
    ray, hits = empty.along(asked)
    assert len(ray) == len(hits.t) == 0


def test_no_rays_have_no_answers(rng):
    scene = world(mixed_scene(rng))
    asked = random_rays(rng, 0)
    assert len(scene.nearest(asked).t) == 0
    assert len(scene.transmittance(asked)) == 0
    assert len(scene.along(asked)[0]) == 0


def test_light_passes_a_mask_exactly_where_it_is_cut_out():
    codes = np.array([[255, 0, 255, 0], [0, 0, 255, 255], [255, 255, 0, 0], [0, 255, 0, 255]])
    scene = masked_quad(codes)
    at = (np.arange(4) + 0.5) / 2 - 1
    x, y = np.meshgrid(at, -at)
    origins = np.stack([x.ravel(), y.ravel(), np.full(16, 2.0)], axis=1)
    asked = rays(origins, [0, 0, -1])
    through = world(scene).transmittance(asked).reshape(4, 4)
    assert (through == (codes == 0)).all()
    solid = world(scene).nearest(asked).triangle.reshape(4, 4) >= 0
    assert (solid == (codes > 0)).all()


@pytest.mark.parametrize("behind", [0.01, 3.0])
def test_what_is_behind_a_hole_is_seen_through_it(behind):
    scene = joined(masked_quad([[0, 255]]), quad(z=-behind))
    hits = world(scene).nearest(rays([[-0.5, 0.3, 1], [0.5, 0.3, 1]], [0, 0, -1]))
    assert (hits.triangle >= 2).tolist() == [True, False]
    assert hits.t == pytest.approx([1 + behind, 1.0])


def test_blended_panes_let_their_part_of_the_light_through():
    panes = [quad(alpha(0.25, "blend"), z=-k) for k in range(5)]
    scene = world(joined(*panes))
    asked = rays([[0.1, 0.3, 1.0]] * 4, [0, 0, -1], [0.5, 1.5, 3.5, np.inf])
    assert scene.transmittance(asked) == pytest.approx([0.75**n for n in (0, 1, 3, 5)])


def test_light_stops_at_what_is_solid_whatever_is_before_it():
    scene = joined(quad(alpha(0.25, "blend"), z=0), masked_quad([[0]], z=-1), quad(z=-2))
    asked = rays([[0.1, 0.3, 1.0]] * 2, [0, 0, -1], [2.5, np.inf])
    assert world(scene).transmittance(asked).tolist() == [0.75, 0]


def test_a_faint_pane_is_looked_through_and_a_dense_one_seen():
    for value, expected in ((0.4, True), (0.6, False)):
        scene = world(joined(quad(alpha(value, "blend")), quad(z=-1)))
        hits = scene.nearest(rays([0.1, 0.3, 1], [0, 0, -1]))
        assert (hits.triangle[0] >= 2) == expected


def test_a_camera_sees_every_layer_and_not_what_is_behind_the_first_solid():
    scene = joined(quad(alpha(0.9, "blend"), z=0), masked_quad([[0]], z=-1), quad(z=-2), quad(z=-3))
    ray, hits = world(scene).along(rays([0.1, 0.3, 1], [0, 0, -1]))
    assert ray.tolist() == [0, 0]
    assert (hits.triangle // 2).tolist() == [0, 2]
    assert hits.t == pytest.approx([1, 3])


def test_a_camera_does_not_see_backs_of_single_sided_triangles_but_light_stops_there():
    scene = world(joined(quad(z=0), quad(alpha(1, "opaque"), z=1)))
    asked = rays([0.1, 0.3, -1], [0, 0, 1])
    _, hits = scene.along(asked)
    assert (hits.triangle // 2).tolist() == [1]
    assert scene.transmittance(asked).tolist() == [0]
    assert scene.nearest(asked).triangle[0] // 2 == 0


@pytest.mark.parametrize("middle", [0.0, 10.0, 1000.0])
@pytest.mark.parametrize("near", [1e-5, 1e-3, 0.1])
def test_a_pane_near_the_start_of_a_ray_takes_light_once(rng, middle, near):
    pane = quad(alpha(0.5, "blend"))
    # Turned at random, so that no coordinate is exact.
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    scene = mesh(pane.positions @ turn.T + middle, pane.triangles, materials=pane.materials)
    # No nearer than a few steps of the coordinates' precision.
    near = max(near, 8 * np.spacing(np.float32(middle)))
    at = rng.uniform(-0.5, 0.5, (500, 3)) * [1, 1, 0] + [0, 0, near]
    directions = rng.normal(size=(500, 3))
    directions[:, 2] = -np.abs(directions[:, 2]) - 0.3
    through = world(scene).transmittance(rays(at @ turn.T + middle, directions @ turn.T))
    # On the diagonal both triangles may be met; one ray in a hundred is near it at most.
    assert (through == 0.5).mean() >= 0.99


def test_many_holes_are_passed():
    pane = masked_quad([[0]])
    step = np.arange(40)[:, None, None]
    scene = mesh(
        pane.positions - [0, 0, 0.1] * step,
        pane.triangles + 4 * step,
        materials=(alpha(0.0, "mask"),),
    )
    far = joined(scene, quad(z=-10))
    hits = world(far).nearest(rays([0.1, 0.3, 1], [0, 0, -1]))
    assert hits.t[0] == pytest.approx(11)
    assert world(far).transmittance(rays([0.1, 0.3, 1], [0, 0, -1], 10.5)).tolist() == [1]
