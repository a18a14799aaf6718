"""Brute-force integrals over all directions of light."""

import numpy as np

from tests.oracles.brdf import gltf_lobes


def map_directions(height, width):
    """Directions (H*W, 3) of a lat-long map's texels and their solid angles (H*W,)."""
    polar = (np.arange(height) + 0.5) / height * np.pi
    azimuth = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    theta, phi = np.meshgrid(polar, azimuth, indexing="ij")
    directions = np.stack(
        [np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], axis=-1
    )
    edges = np.cos(np.arange(height + 1) / height * np.pi)
    angles = np.repeat((edges[:-1] - edges[1:]) * 2 * np.pi / width, width)
    return directions.reshape(-1, 3), angles


def outgoing(radiance, normal, view, base, metallic, roughness, dielectric_f0=0.04):
    """Diffuse and specular radiance (3,), (3,) towards `view` under a lat-long map."""
    light, angles = map_directions(*radiance.shape[:2])
    diffuse, specular = gltf_lobes(normal, view, light, base, metallic, roughness, dielectric_f0)
    arriving = radiance.reshape(-1, 3) * (angles * np.maximum(light @ normal, 0))[:, None]
    return (diffuse * arriving).sum(0), (specular * arriving).sum(0)


def albedo(nov, base, metallic, roughness, dielectric_f0=0.04, steps=1000):
    """Diffuse and specular directional albedo (3,), (3,), over a grid warped into the lobe."""
    normal = np.array([0.0, 0.0, 1.0])
    view = np.array([np.sqrt(1 - nov**2), 0.0, nov])
    alpha = max(roughness**2, 1e-3)

    # Half vectors uniform in D's own distribution, reflected: a change of variables, not a sample
    u = (np.arange(steps) + 0.5) / steps
    phi = (np.arange(steps // 2) + 0.5) / (steps // 2) * np.pi
    cosine = np.sqrt((1 - u) / (1 + (alpha**2 - 1) * u))
    sine = np.sqrt(1 - cosine**2)
    half = np.stack(
        [
            np.outer(sine, np.cos(phi)),
            np.outer(sine, np.sin(phi)),
            np.outer(cosine, np.ones_like(phi)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    density = alpha**2 / (np.pi * ((1 - half[:, 2] ** 2) * (1 - alpha**2) + alpha**2) ** 2)
    voh = half @ view
    light = 2 * voh[:, None] * half - view
    seen = (voh > 0) & (light[:, 2] > 0)
    light, per_half = light[seen], (density * half[:, 2] / (4 * np.abs(voh)))[seen]
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    _, specular = gltf_lobes(normal, view, light, base, metallic, roughness, dielectric_f0)
    specular = (specular * (light[:, 2] / per_half)[:, None]).sum(0) / len(half)

    # Cosine lobe, likewise
    flat = np.stack([np.outer(np.sqrt(u), np.cos(phi)), np.outer(np.sqrt(u), np.sin(phi))], -1)
    up = np.repeat(np.sqrt(1 - u), len(phi))
    light = np.concatenate([flat.reshape(-1, 2), up[:, None]], axis=1)
    diffuse, _ = gltf_lobes(normal, view, light, base, metallic, roughness, dielectric_f0)
    return diffuse.mean(0) * np.pi, specular
