"""The text of an AVL geometry file as blocks: header, surfaces, sections, controls. No meaning is given to them yet."""

from dataclasses import dataclass, field
from pathlib import Path

from hera_om.aircraft.airfoils import CoordinateFileError, Coordinates, coordinates_of, read_coordinates
from hera_om.core.errors import Problem

_KEYWORDS = (
    "SURFACE COMPONENT INDEX YDUPLICATE SCALE TRANSLATE ANGLE NOWAKE NOALBE NOLOAD CDCL SECTION NACA AIRFOIL "
    "AFILE CLAF CONTROL DESIGN BODY BFILE"
).split()
_BY_START = {k[:4]: k for k in _KEYWORDS}  # AVL reads four letters
_IGNORED = {  # keyword -> lines that follow, what is lost
    "CDCL": (1, "section drag polars"),
    "CLAF": (1, "factors on the section lift slope"),
    "DESIGN": (1, "design variables"),
    "BODY": (0, "bodies"),
}
_REFUSED = {
    "NOWAKE": "a surface without a wake",
    "NOALBE": "a surface that does not feel incidence",
    "NOLOAD": "a surface whose loads do not count",
}


@dataclass
class AvlControl:
    """A CONTROL line."""

    line: int
    name: str
    gain: float
    hinge: float
    axis: tuple[float, ...]
    mirror: float


@dataclass
class AvlSection:
    """A SECTION with what follows it."""

    line: int
    place: tuple[float, ...]  # Xle Yle Zle chord Ainc
    strips: int
    spacing: float
    naca: str | None = None
    coordinates: Coordinates | None = None
    controls: list[AvlControl] = field(default_factory=list)


@dataclass
class AvlSurface:
    """A SURFACE with its sections."""

    line: int
    name: str
    chordwise: int
    chordwise_spacing: float
    spanwise: int
    spacing: float
    mirrored: bool = False
    scale: tuple[float, ...] = (1.0, 1.0, 1.0)
    shift: tuple[float, ...] = (0.0, 0.0, 0.0)
    angle: float = 0.0
    component: int | None = None
    sections: list[AvlSection] = field(default_factory=list)


class AvlText:
    """The blocks of one file; `problems` and `warnings` say what could not be taken."""

    def __init__(self, text: str, file: str) -> None:
        self.file = file
        self.problems: list[Problem] = []
        self.warnings: list[str] = []
        self.surfaces: list[AvlSurface] = []
        self._lines = [(i, line) for i, raw in enumerate(text.splitlines(), 1) if (line := _bare(raw))]
        self._at = 0
        self._in_body = False
        self._header()
        while self._at < len(self._lines):
            self._block()

    def _header(self) -> None:
        """Title, Mach number, symmetry, reference quantities and point, profile drag."""
        self.title = self._next("the title")[1]
        (self.mach,) = self._numbers("the Mach number", 1, 1)
        self.symmetry = self._numbers("iYsym iZsym Zsym", 2, 3)
        self.symmetry_line = self._line()
        self.reference = self._numbers("Sref Cref Bref", 3, 3)
        self.point = self._numbers("Xref Yref Zref", 3, 3)
        self.drag = 0.0
        if self._at < len(self._lines) and _keyword(self._lines[self._at][1]) is None:
            (self.drag,) = self._numbers("CDp, or a keyword", 1, 1)

    def _block(self) -> None:
        """One keyword with the lines that belong to it."""
        line, text = self._next("a keyword")
        keyword = _keyword(text)
        if keyword is None:
            self._fault(line, text, f"a keyword of AVL: {', '.join(_KEYWORDS)}")
        elif keyword in _REFUSED:
            self._fault(line, text, f"no {keyword}: {_REFUSED[keyword]} has no counterpart here")
        elif keyword == "SURFACE":
            self._in_body = False
            self._surface(line)
        elif keyword == "BODY":
            self._in_body = True
            self._warn(f"line {line}: {keyword} is left out ({_IGNORED[keyword][1]})")
            self._at += 2
        elif keyword in _IGNORED:
            self._warn(f"line {line}: {keyword} is left out ({_IGNORED[keyword][1]})")
            self._at += _IGNORED[keyword][0]
        elif self._in_body:
            self._at += 1
        elif not self.surfaces:
            self._fault(line, text, "SURFACE before it")
            self._skip_data()
        else:
            self._of_surface(keyword, line, text)

    def _surface(self, line: int) -> None:
        """SURFACE: its name and its numbers of vortices."""
        name = self._next("the name of the surface")[1]
        v = self._numbers("Nchord Cspace, and Nspan Sspace where sections have none", 2, 4)
        v = v + (0.0,) * (4 - len(v))
        self.surfaces.append(AvlSurface(line, name, round(v[0]), v[1], round(v[2]), v[3]))

    def _of_surface(self, keyword: str, line: int, text: str) -> None:
        """A keyword inside a surface."""
        surface = self.surfaces[-1]
        if keyword in ("COMPONENT", "INDEX"):
            surface.component = round(self._numbers("an index", 1, 1)[0])
        elif keyword == "YDUPLICATE":
            (plane,) = self._numbers("Ydupl", 1, 1)
            surface.mirrored = True
            if plane != 0.0:
                self._fault(line, plane, "YDUPLICATE about y = 0")
        elif keyword == "SCALE":
            surface.scale = self._numbers("Xscale Yscale Zscale", 3, 3)
        elif keyword == "TRANSLATE":
            surface.shift = self._numbers("dX dY dZ", 3, 3)
        elif keyword == "ANGLE":
            (surface.angle,) = self._numbers("dAinc", 1, 1)
        elif keyword == "SECTION":
            v = self._numbers("Xle Yle Zle chord Ainc, and Nspan Sspace where the surface has none", 5, 7)
            v = v + (0.0,) * (7 - len(v))
            surface.sections.append(AvlSection(line, v[:5], round(v[5]), v[6]))
        elif not surface.sections:
            self._fault(line, text, "SECTION before it")
            self._skip_data()
        else:
            self._of_section(keyword, line, text, surface.sections[-1])

    def _of_section(self, keyword: str, line: int, text: str, section: AvlSection) -> None:
        """A keyword inside a section."""
        if keyword in ("NACA", "AIRFOIL", "AFILE"):
            span = _floats(text.split()[1:])
            if span and span != (0.0, 1.0):
                self._fault(line, text, f"{keyword} over the whole chord, without X1 X2 or with 0 1")
        if keyword == "NACA":
            section.naca = self._next("the digits")[1].split()[0]
        elif keyword == "AIRFOIL":
            section.coordinates = self._points(line)
        elif keyword == "AFILE":
            section.coordinates = self._file()
        elif keyword == "CONTROL":
            self._control(section)

    def _control(self, section: AvlSection) -> None:
        """CONTROL: name, gain, hinge, axis, sign of the image."""
        line, text = self._next("name gain Xhinge XYZhvec SgnDup")
        name, *words = text.split()
        v = _floats(words)
        if len(v) not in (2, 5, 6):
            self._fault(line, text, "name gain Xhinge XYZhvec SgnDup")
            return
        v = v + (0.0, 0.0, 0.0, 1.0)[len(v) - 2 :]
        if not 0.0 <= v[1] < 1.0:
            expected = "Xhinge from 0 to less than 1; controls ahead of a hinge line are not known"
            self._fault(line, v[1], expected)
            return
        section.controls.append(AvlControl(line, name, v[0], v[1], v[2:5], v[5]))

    def _points(self, line: int) -> Coordinates | None:
        """The coordinates that follow AIRFOIL."""
        rows = []
        while self._at < len(self._lines) and len(_floats(self._lines[self._at][1].split())) >= 2:
            rows.append(" ".join(self._lines[self._at][1].split()[:2]))
            self._at += 1
        return self._coordinates(line, "AIRFOIL", lambda: coordinates_of(rows))

    def _file(self) -> Coordinates | None:
        """The coordinates of the file that AFILE names, from the folder of the geometry file."""
        line, text = self._next("the name of a coordinate file")
        name = text.strip("\"'")
        return self._coordinates(line, name, lambda: read_coordinates(Path(self.file).parent / name))

    def _coordinates(self, line: int, value: str, read) -> Coordinates | None:
        """Coordinates, or the problem that they have."""
        try:
            return read()
        except CoordinateFileError as error:
            self._fault(line, value, f"coordinates, Selig's or Lednicer's format; {error}")
            return None

    def _next(self, what: str) -> tuple[int, str]:
        """The next line, blank and comment lines left out."""
        if self._at >= len(self._lines):
            self._fault(self._line() + 1, None, f"{what}; the file ends here")
            return self._line() + 1, "?"
        self._at += 1
        return self._lines[self._at - 1]

    def _numbers(self, what: str, least: int, most: int) -> tuple[float, ...]:
        """The numbers at the start of the next line; zeros where they are missing."""
        line, text = self._next(what)
        values = _floats(text.replace(",", " ").split())[:most]
        if len(values) < least:
            if text != "?":
                self._fault(line, text, what)
            if _keyword(text) is not None:
                self._at -= 1
            return (0.0,) * least
        return values

    def _skip_data(self) -> None:
        """Pass over the lines up to the next keyword."""
        while self._at < len(self._lines) and _keyword(self._lines[self._at][1]) is None:
            self._at += 1

    def _line(self) -> int:
        """Number of the line that was read last."""
        return self._lines[self._at - 1][0] if self._lines and self._at else 0

    def _fault(self, line: int, value: object, expected: str) -> None:
        self.problems.append(Problem(self.file, f"line {line}", value, expected))

    def _warn(self, text: str) -> None:
        if text not in self.warnings:
            self.warnings.append(text)


def _bare(raw: str) -> str:
    """A line without comments."""
    return "" if raw.lstrip().startswith("#") else raw.split("!")[0].strip()


def _keyword(text: str) -> str | None:
    """The keyword that a line starts with; AVL compares four letters."""
    word = text.split()[0].upper() if text.split() else ""
    found = _BY_START.get(word[:4])
    return found if found is not None and word.isalpha() else None


def _floats(words: list[str]) -> tuple[float, ...]:
    """The numbers at the start of a list of words; Fortran's D exponents are known."""
    out = []
    for word in words:
        try:
            value = float(word.upper().replace("D", "E"))
        except ValueError:
            break
        if value - value != 0.0:  # nan and inf
            break
        out.append(value)
    return tuple(out)
