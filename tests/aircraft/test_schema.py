"""The schema as data: descriptions, units, ranges, and the page of the documentation."""

import re
from pathlib import Path

import pytest

from hera_om.aircraft import loads, schema_markdown, unit_of
from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import key_at, keys_of, tables_of

PAGE = Path(__file__).parents[2] / "docs" / "definition.md"
EVERY_KEY = [
    (f"{path}.{name}".lstrip("."), key) for path, part, _ in tables_of(Aircraft) for name, key in keys_of(part).items()
]


def test_page_is_current():
    assert PAGE.read_text("utf-8").endswith(schema_markdown()), "rewrite the table of docs/definition.md"


def test_example_of_the_page_is_a_definition():
    text = PAGE.read_text("utf-8").split("```toml\n")[1].split("```")[0]
    assert loads(text).variables[0].path == "wing.section.tip.twist_deg"


@pytest.mark.parametrize(("path", "key"), EVERY_KEY, ids=[path for path, _ in EVERY_KEY])
def test_every_key_says_what_it_is_and_numbers_say_their_unit(path, key):
    assert key.description, path
    if key.kind not in ("number", "numbers") or path.startswith("variables."):
        return
    unit = re.search(r"\[([^\]]+)\]$", key.description)[1]
    expected = (unit_of(path) or "-").replace("**", "")
    assert unit == expected, path


def test_page_has_every_key_with_its_range():
    text = PAGE.read_text("utf-8")
    assert all(f"| `{key.name}` |" in text for _, key in EVERY_KEY)
    assert "| `mach` | - | number >= 0 and < 1 | required | Mach number |" in text


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("wing.section.any.chord_m", "chord_m"),
        ("blade.b.r.3", "r"),
        ("htail.scale", "scale"),
        ("wing.section", None),
        ("wing.section.kink", "section"),
        ("wing.nothing", None),
        ("htail.scale.more", None),
        ("", None),
    ],
)
def test_key_at_a_path(path, name):
    found = key_at(Aircraft, path)
    assert (found.name if found else None) == name
