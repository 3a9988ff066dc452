"""Lengths as people write them: packs of boulders in metres, of powders in micrometres."""


def length_unit(length: float) -> tuple[float, str]:
    """Factor and name of the unit in which a length [m] is a number from 1 to 1000, or the nearest to that there is."""
    for limit, factor, name in ((1e-6, 1e9, "nm"), (1e-3, 1e6, "µm"), (1.0, 1e3, "mm")):
        if abs(length) < limit:
            return factor, name
    return 1.0, "m"
