"""Mass items."""

from hera_om.aircraft.fields import NAME, Part, item, number

TRACKS = r"^(wing|htail|vtail|fuel|rotor:[A-Za-z][A-Za-z0-9_]*)$"


class Mass(Part):
    """A mass item, both sides together.

    kx, ky, kz are the root-mean-square distances of its mass from its own centre ALONG x, y and z, so that
    about its own centre Ixx = m (ky^2 + kz^2), Iyy = m (kx^2 + kz^2), Izz = m (kx^2 + ky^2). They are not
    radii of gyration about those axes.
    """

    name: str = item("name of the item", pattern=NAME)
    m_kg: float = number("mass", "kg", ge=0)
    x_m: float = number("centre of gravity, x", "m")
    y_m: float = number("centre of gravity, y; 0 for a pair", "m", 0.0)
    z_m: float = number("centre of gravity, z", "m", 0.0)
    kx_m: float = number("root-mean-square spread of the mass along x", "m", 0.0, ge=0)
    ky_m: float = number("root-mean-square spread of the mass along y", "m", 0.0, ge=0)
    kz_m: float = number("root-mean-square spread of the mass along z", "m", 0.0, ge=0)
    tracks: str | None = item(
        "what moves it: wing (mass from the sizing), htail or vtail (mass with the area), rotor:<group> "
        "(ky follows the hubs), fuel",
        None,
        pattern=TRACKS,
    )
