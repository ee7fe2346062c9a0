"""Pieces of a self-contained HTML page: style sheet, tables, pictures as inline SVG."""

import html
import io
import re
from collections.abc import Iterable, Sequence

from matplotlib import rc_context
from matplotlib.figure import Figure

CSS = """
:root{--ink:#222;--soft:#666;--line:#ddd;--good:#00713b;--bad:#c8321e;--mark:#0072b2}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:#f6f6f4;color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:68rem;margin:0 auto;padding:1.2rem}
header,section{background:#fff;border:1px solid var(--line);border-radius:6px;
padding:1rem 1.2rem;margin:0 0 1rem}
h1{font-size:1.6rem;line-height:1.2;margin:0 0 .3rem}
h2{font-size:1.15rem;margin:0 0 .6rem}
p{margin:.3rem 0 .7rem}
.soft,footer{color:var(--soft);font-size:.9rem}
.badge{display:inline-block;padding:.1rem .6rem;border-radius:1rem;color:#fff;
background:var(--soft);font-size:.9rem;margin:0 .3rem .3rem 0}
.badge.good{background:var(--good)}.badge.bad{background:var(--bad)}
.facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(9.5rem,1fr));
gap:.7rem;margin:.8rem 0;padding:0}
.facts div{border-left:3px solid var(--mark);padding-left:.6rem}
.facts dt{color:var(--soft);font-size:.85rem}.facts dd{margin:0;font-weight:600;overflow-wrap:anywhere}
nav{display:flex;flex-wrap:wrap;gap:.2rem 1rem;margin:0 0 1rem;font-size:.95rem}
a{color:var(--mark)}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.92rem;font-variant-numeric:tabular-nums}
th,td{padding:.28rem .6rem;border-bottom:1px solid var(--line);text-align:left;
white-space:nowrap;vertical-align:top}
th{font-weight:600;border-bottom:2px solid #bbb}
td.n,th.n{text-align:right}
td.wide{white-space:normal;min-width:9rem;color:var(--soft)}
tr.bad td{color:var(--bad)}
tr.sum td{border-top:2px solid #bbb;font-weight:600}
figure{margin:.4rem 0 .8rem}
figure svg{display:block;width:100%;min-width:36rem;max-width:46rem;height:auto;margin:0 auto}
details{margin:.6rem 0 0}summary{cursor:pointer;color:var(--mark)}
pre{overflow-x:auto;background:#f6f6f4;padding:.7rem;font-size:.82rem;line-height:1.4}
.note{border-left:4px solid var(--bad);background:#fdf3f1;padding:.5rem .8rem;margin:.4rem 0;
overflow-wrap:anywhere}
@media(max-width:34rem){main{padding:.5rem}header,section{padding:.8rem}td.wide{white-space:nowrap}}
@media print{body{background:#fff;font-size:11px}main{max-width:none;padding:0}nav{display:none}
header,section{border:0;padding:.3rem 0}figure,tr,.facts{break-inside:avoid}h2{break-after:avoid}
.scroll{overflow:visible}figure svg{min-width:0;max-width:16cm}}
"""


def escape(value: object) -> str:
    """Text that is safe in HTML."""
    return html.escape(str(value))


def document(title: str, body: str) -> str:
    """A whole page; nothing in it is loaded from elsewhere, and a browser is told not to."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta http-equiv="Content-Security-Policy" content="'
        "default-src 'none'; style-src 'unsafe-inline'\">\n"
        f"<title>{escape(title)}</title>\n<style>{CSS}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def section(anchor: str, title: str, content: str) -> str:
    """A pane with its title."""
    return f'<section id="{anchor}">\n<h2>{escape(title)}</h2>\n{content}\n</section>'


def note(text: str) -> str:
    """A visible remark that something is missing or failed."""
    return f'<p class="note">{escape(text)}</p>'


def badge(text: str, kind: str = "") -> str:
    """A short coloured label; ``kind`` is ``good``, ``bad`` or nothing."""
    return f'<span class="badge {kind}">{escape(text)}</span>'


def facts(pairs: Iterable[tuple[str, str]]) -> str:
    """Labelled values side by side."""
    cells = "".join(f"<div><dt>{escape(k)}</dt><dd>{escape(v)}</dd></div>" for k, v in pairs)
    return f'<dl class="facts">{cells}</dl>'


def table(
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    text: Sequence[int] = (0,),
    classes: Sequence[str] = (),
) -> str:
    """A table; the columns in ``text`` are words, all others numbers; ``classes`` has one entry a row.

    The last column is allowed to wrap when it is text.
    """

    def cell(tag: str, i: int, value: str) -> str:
        kind = "" if i in text else ' class="n"'
        if tag == "td" and i in text and 0 < i == len(head) - 1:
            kind = ' class="wide"'
        return f"<{tag}{kind}>{escape(value)}</{tag}>"

    lines = ["<tr>" + "".join(cell("th", i, h) for i, h in enumerate(head)) + "</tr>"]
    for number, row in enumerate(rows):
        kind = f' class="{classes[number]}"' if classes and classes[number] else ""
        lines.append(f"<tr{kind}>" + "".join(cell("td", i, v) for i, v in enumerate(row)) + "</tr>")
    return '<div class="scroll"><table>\n' + "\n".join(lines) + "\n</table></div>"


def folded(summary: str, content: str) -> str:
    """Content that opens at a click."""
    return f"<details><summary>{escape(summary)}</summary>\n{content}\n</details>"


def picture(figure: Figure, name: str, description: str) -> str:
    """A figure as inline SVG: identifiers made unique by the name, no metadata, no foreign address."""
    buffer = io.StringIO()
    with rc_context({"svg.fonttype": "path", "svg.hashsalt": name}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r"<!--.*?-->\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", svg).replace("xlink:href", "href")
    svg = re.sub(r'(\sid="|href="#|url\(#)', rf"\g<1>{name}-", svg)
    opening = re.sub(r'\s(width|height|version)="[^"]*"', "", svg[: svg.index(">") + 1])
    opening = opening.replace("<svg", f'<svg role="img" aria-label="{escape(description)}"', 1)
    return f'<figure class="scroll">{opening}{svg[svg.index(">") + 1 :]}</figure>'
