"""The page: every pane from the database alone, self-contained, each pane on its own feet."""

import re
from html.parser import HTMLParser

import pytest

from hera_om import post
from hera_om.aircraft import load_aircraft
from hera_om.core.errors import RecordError
from hera_om.post import report
from hera_om.studies.record import Record

VOID = {"meta", "br", "path", "use", "rect"}


class Checker(HTMLParser):
    """Collects identifiers, links and tags, and sees that tags close in order."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.tags, self.text = [], [], [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for key, value in attrs:
            if key == "id":
                self.ids.append(value)
            if key in ("href", "src"):
                self.links.append(value)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def parse(text):
    """A page, parsed."""
    checker = Checker()
    checker.feed(text)
    checker.close()
    assert checker.open == []
    return checker


@pytest.fixture(scope="module")
def html(database, tmp_path_factory):
    """The page of the synthetic run."""
    target = tmp_path_factory.mktemp("page") / "mdo.html"
    assert post.write_report(database, target) == target
    return target.read_text(encoding="utf-8")


def test_nothing_is_loaded_from_elsewhere(html):
    page = parse(html)
    assert all(link.startswith("#") for link in page.links)
    assert not {"script", "link", "img", "iframe", "image", "object"} & set(page.tags)
    assert not re.search(r"https?:|//[a-z]|@import|url\((?!#)", html)


def test_links_point_to_identifiers_and_those_are_unique(html):
    page = parse(html)
    assert len(page.ids) == len(set(page.ids))
    assert {link[1:] for link in page.links} <= set(page.ids)
    assert {target for target in re.findall(r"url\(#([^)]+)\)", html)} <= set(page.ids)


def test_every_pane_is_there_and_none_failed(html):
    page = parse(html)
    for pane in report.PANES:
        assert pane.anchor in page.ids and pane.title in page.text
    assert "could not be made" not in html
    assert html.count("<svg") == 10


@pytest.mark.parametrize(
    "told",
    [
        "hera_like", "converged", "feasible", "SLSQP", "58.3 s",
        "1\u2009218 → 1\u2009396 km (+14.6 %)", "−11.5 %",
        "at bound", "active", "61.2", "Table 7", "cm²", "induced, near field",
        "−10.20", "Optimisation",
        "spar caps", "wing.section", "openmdao",
    ],
)  # fmt: skip
def test_numbers_and_words_are_on_the_page(html, told):
    assert told in "".join(parse(html).text)


def test_the_hash_stands_short_in_the_head_and_long_at_the_end(html, database):
    whole = post.read(database).definition_hash
    assert f"definition {whole[:12]} " in html and whole in html


def test_a_failing_pane_is_a_note_and_the_rest_stays(database, monkeypatch):
    def broken(run):
        raise ZeroDivisionError("no <b>span</b>")

    panes = [p._replace(write=broken) if p.anchor in ("drag", "load") else p for p in report.PANES]
    monkeypatch.setattr(report, "PANES", tuple(panes))
    text = report.render(post.read(database))
    assert text.count("This pane could not be made: ZeroDivisionError: no &lt;b&gt;span&lt;/b&gt;") == 2
    assert text.count("<svg") == 8 and "Short-period thumbprint" in text


def test_a_snapshot_without_arrays_costs_only_its_pictures(tmp_path, synthetic):
    with Record(tmp_path / "a.db", kind="analyze", aircraft=load_aircraft("wing_alone")) as r:
        r.snapshot("baseline", {"values": {"CL": 0.5, "CD": 0.02}})
        r.result({"success": True})
    text = report.render(post.read(tmp_path / "a.db"))
    parse(text)
    assert "could not be made" not in text and "0.5000" in text and "wing_alone" in text
    assert "no snapshot with a planform was recorded" not in text  # the words are paths of the picture
    assert 'id="history"' not in text and 'id="constraints"' not in text


def test_text_of_the_record_is_escaped(tmp_path, database):
    with Record(
        tmp_path / "a.db",
        kind="mdo",
        aircraft=load_aircraft("hera_like"),
        options={"driver": "<script>x</script>"},
    ) as r:
        r.result({"message": "<img src=x>", "success": False})
    page = parse(report.render(post.read(tmp_path / "a.db")))
    assert "script" not in page.tags and "img" not in page.tags


@pytest.mark.parametrize(
    ("until", "told"),
    [("head", "has not finished; 0 evaluations"), ("history", "has not finished; 12 evaluations")],
)
def test_an_unfinished_run_has_a_page_that_says_so(tmp_path, synthetic, until, told):
    text = report.render(post.read(synthetic.write(tmp_path / "a.db", until=until)))
    parse(text)
    assert told in text and "unfinished" in text and "could not be made" not in text


def test_a_run_that_stopped_says_why(tmp_path):
    with (
        pytest.raises(RuntimeError),
        Record(tmp_path / "a.db", kind="mdo", aircraft=load_aircraft("hera_like")),
    ):
        raise RuntimeError("elevator saturated")
    text = report.render(post.read(tmp_path / "a.db"))
    assert "The run stopped: elevator saturated" in text and "failed" in text


def test_an_infeasible_run_is_labelled(tmp_path, synthetic):
    result = synthetic.result() | {"feasible": False, "success": False}
    result["constraints"]["RFC"] |= {"violated": True, "margin": -0.2}
    aircraft = load_aircraft("hera_like")
    with Record(tmp_path / "a.db", kind="mdo", aircraft=aircraft, constraints=synthetic.constraints) as r:
        r.result(result)
    text = report.render(post.read(tmp_path / "a.db"))
    assert 'class="badge bad">infeasible' in text and 'class="badge bad">not converged' in text
    assert re.search(r'<tr class="bad"><td>RFC</td>.*violated', text)


def test_a_page_that_cannot_be_written_names_the_file(database, tmp_path):
    with pytest.raises(RecordError, match=r"nowhere/a\.html: the report cannot be written"):
        post.write_report(database, tmp_path / "nowhere" / "a.html")
    (tmp_path / "folder").mkdir()
    with pytest.raises(RecordError, match="folder: the report cannot be written"):
        post.write_report(database, tmp_path / "folder")
    assert [p.name for p in tmp_path.iterdir()] == ["folder"]


def test_the_same_database_gives_the_same_page(database):
    assert report.render(post.read(database)) == report.render(post.read(database))
