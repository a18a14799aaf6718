"""How a ray changes from a pixel to the next: first derivatives along its path.

Igehy 1999, "Tracing Ray Differentials", section 3. A ray has an origin P and a unit direction D;
its differential (dP, dD) is what they change by per step of one pixel, along one axis of the
picture. dD is perpendicular to D. Nothing here knows of a scene; everything is computed in the
precision that it is given.

Where a formula divides by the cosine between a ray and a surface, that cosine is kept at least
LEAST_COSINE from zero, and `bounded` limits what is handed on to LARGEST, so that neither infinity
nor NaN leaves.
"""

import math

from raysvc.geometry.refraction import transmitted_cosine
from raysvc.geometry.vector_kernels import Vec3, cross, dot, plus, scaled
from raysvc.jit import inlined

LEAST_COSINE = 1e-4
"""Rays nearer to the plane of a surface than this are treated as if they were not."""
LARGEST = 1e8
"""Greatest component of a differential; anything that large covers everything there is."""
NO_STEP: Vec3 = (0.0, 0.0, 0.0)


@inlined
def away_from_zero(cosine: float) -> float:
    """A cosine of the same sign that is safe to divide by."""
    return math.copysign(max(abs(cosine), LEAST_COSINE), cosine)


@inlined
def bounded(step: Vec3) -> Vec3:
    """A vector with components of at most LARGEST, in the same direction; zero for inf and NaN."""
    if not (abs(step[0]) < math.inf and abs(step[1]) < math.inf and abs(step[2]) < math.inf):
        return NO_STEP
    greatest = max(abs(step[0]), abs(step[1]), abs(step[2]))
    return scaled(step, LARGEST / greatest) if greatest > LARGEST else step


@inlined
def unit_step(direction: Vec3, length: float, step: Vec3) -> Vec3:
    """What a unit vector changes by when the vector of that `length` along it changes by `step`.

    For a pinhole camera's rays `step` is the width of a pixel at distance 1 along the view, and
    `length` is 1 / (D . forward): the equation ((d.d)R - (d.R)d) / (d.d)^1.5 for D = d / |d|.
    """
    return scaled(plus(step, direction, -dot(direction, step)), 1.0 / length)


@inlined
def transferred(
    direction: Vec3, origin_step: Vec3, direction_step: Vec3, t: float, plane_normal: Vec3
) -> Vec3:
    """What the point at distance t changes by, on the plane that the ray meets there.

    The plane is that of the triangle, whatever its shading normal is; `plane_normal` may have any
    length but zero.
    """
    step = plus(origin_step, direction_step, t)
    length = math.sqrt(dot(plane_normal, plane_normal))
    cosine = away_from_zero(dot(direction, plane_normal) / length)
    return plus(step, direction, -dot(step, plane_normal) / (length * cosine))


@inlined
def reflected_step(direction: Vec3, direction_step: Vec3, normal: Vec3, normal_step: Vec3) -> Vec3:
    """What the mirrored direction D - 2 (D.N) N changes by."""
    cosine = dot(direction, normal)
    cosine_step = dot(direction_step, normal) + dot(direction, normal_step)
    step = plus(direction_step, normal_step, -2.0 * cosine)
    return plus(step, normal, -2.0 * cosine_step)


@inlined
def refracted_step(
    direction: Vec3, direction_step: Vec3, normal: Vec3, normal_step: Vec3, eta: float
) -> Vec3:
    """What the refracted direction eta D - mu N changes by; zero where all light is reflected.

    `normal` is on the side from which the ray comes; eta is the index of refraction there over that
    beyond.
    """
    cosine = dot(direction, normal)
    beyond = -transmitted_cosine(-cosine, eta)
    if beyond == 0.0:
        return NO_STEP
    cosine_step = dot(direction_step, normal) + dot(direction, normal_step)
    mu = eta * cosine - beyond
    mu_step = (eta - eta * eta * cosine / away_from_zero(beyond)) * cosine_step
    step = plus(scaled(direction_step, eta), normal_step, -mu)
    return plus(step, normal, -mu_step)


@inlined
def barycentric_gradients(a: Vec3, b: Vec3, c: Vec3) -> tuple[Vec3, Vec3]:
    """Gradients in space of the weights of b and c, from the triangle's edges; zero without area.

    A step dp on the triangle's plane changes the weights by their products with dp, and that of a
    by what makes the sum zero.
    """
    e1, e2 = plus(b, a, -1.0), plus(c, a, -1.0)
    across = cross(e1, e2)
    square = dot(across, across)
    # Without area; also where the square leaves the range of doubles.
    if not 1e-280 < square < math.inf:
        return NO_STEP, NO_STEP
    return (
        scaled(cross(e2, across), 1.0 / square),
        scaled(cross(across, e1), 1.0 / square),
    )


@inlined
def interpolated_normal_step(
    normal_a: Vec3, normal_b: Vec3, normal_c: Vec3, u: float, v: float, du: float, dv: float
) -> Vec3:
    """What the unit interpolated normal n / |n|, n = (1-u-v) n_a + u n_b + v n_c, changes by.

    Zero where the normals cancel.
    """
    along_u, along_v = plus(normal_b, normal_a, -1.0), plus(normal_c, normal_a, -1.0)
    n = plus(plus(normal_a, along_u, u), along_v, v)
    square = dot(n, n)
    if square < 1e-20:
        return NO_STEP
    step = plus(scaled(along_u, du), along_v, dv)
    return scaled(plus(step, n, -dot(n, step) / square), 1.0 / math.sqrt(square))
