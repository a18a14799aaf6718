import dataclasses

import numpy as np
import pytest

import raysvc
from bench.reference_cache import name_of, reference_picture
from raysvc.scene import Material, Texture, TextureRef
from tests.scenes import chequered, quad

VIEW = raysvc.View(eye=(0, 0, 3), width=8, height=6)
SETTINGS = raysvc.Settings(occlusion_samples=0, aa="none", threads=2)


def scene(*rows, roughness=1.0):
    material = Material(base_colour_texture=TextureRef(0), roughness=roughness)
    return quad(material, textures=(Texture(chequered(*rows)),))


def light(value):
    return raysvc.Environment(np.full((4, 8, 3), value, np.float32))


PICTURE = (scene((0, 255), (255, 0)), light(0.5), VIEW, SETTINGS)


def test_a_picture_is_named_by_what_it_shows():
    same = (scene((0, 255), (255, 0)), light(0.5), VIEW, SETTINGS)
    renamed = dataclasses.replace(same[0], name="board", warnings=("old",))
    patient = SETTINGS.model_copy(update={"threads": 1, "deadline_s": 5.0})
    assert name_of(*PICTURE) == name_of(*same) == name_of(renamed, same[1], VIEW, patient)


@pytest.mark.parametrize(
    ("place", "other"),
    [
        (0, scene((0, 255), (255, 1))),
        (0, scene((0, 255), (255, 0), roughness=0.5)),
        (1, light(0.6)),
        (2, VIEW.model_copy(update={"eye": (0, 0, 4)})),
        (2, VIEW.model_copy(update={"aperture_radius": 0.1})),
        (3, SETTINGS.model_copy(update={"exposure_stops": 1.0})),
    ],
)
def test_another_picture_has_another_name(place, other):
    changed = [*PICTURE[:place], other, *PICTURE[place + 1 :]]
    assert name_of(*changed) != name_of(*PICTURE)


def test_what_cannot_be_told_apart_is_not_hashed():
    odd = dataclasses.replace(PICTURE[0], lights=(object(),))
    with pytest.raises(TypeError, match="object"):
        name_of(odd, *PICTURE[1:])


def test_a_picture_is_made_once_and_kept(tmp_path, monkeypatch):
    folder = tmp_path / "references"
    made, seconds = reference_picture(folder, *PICTURE)
    np.testing.assert_array_equal(made, raysvc.render(*PICTURE).layers["beauty"])
    monkeypatch.setattr(raysvc, "render", None)
    kept, kept_seconds = reference_picture(folder, *PICTURE)
    np.testing.assert_array_equal(kept, made)
    assert kept_seconds == seconds > 0
    assert [path.name for path in folder.iterdir()] == [f"{name_of(*PICTURE)}.npz"]


def test_without_a_folder_nothing_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made, _ = reference_picture(None, *PICTURE)
    assert made.shape == (6, 8, 4)
    assert not list(tmp_path.iterdir())
