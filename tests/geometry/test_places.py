import numpy as np

from raysvc.geometry.places import welded


def test_places_are_told_apart_as_single_precision_tells_numbers_apart():
    places = welded(np.array([[0.0, 1, 2], [1e-30, 1, 2], [-0.0, 1, 2], [0, 1 + 1e-12, 2]]))
    assert places[0] == places[2] == places[3] != places[1]
    assert sorted(set(places.tolist())) == [0, 1]


def test_no_vertices_are_at_no_places():
    assert welded(np.zeros((0, 3))).shape == (0,)
