import re

import pytest

from evenroad.errors import InvalidValue
from evenroad_studies.report.tables import Entry, Table, as_html, as_latex, as_markdown

NASTY = "a|b <i> & 50% of_{x} \\ ~^#$"


def _table(**fields):
    rows = ((Entry("uniform"), Entry("52.8 [50, 56]", "better")), (Entry(NASTY), Entry("≤ 32", "differs")))
    return Table(
        **({"name": "t", "title": NASTY, "header": ("sampler", "N > 3"), "rows": rows, "notes": (NASTY,)} | fields)
    )


def test_html_escapes_what_it_must_and_marks_by_class():
    text = as_html(_table())
    assert "<i>" not in text
    assert text.count("&lt;i&gt;") == 3
    assert "<td class='better'>52.8 [50, 56]</td>" in text
    assert "<td class='label'>uniform</td>" in text
    text = as_html(_table(header=("sampler", "rule", "N"), rows=((Entry("a"), Entry("b"), Entry("1")),), labels=2))
    assert "<tr><th class='label'>sampler</th><th class='label'>rule</th><th>N</th></tr>" in text
    assert "<td class='label'>a</td><td class='label'>b</td><td>1</td>" in text


def test_markdown_has_as_many_columns_in_every_line():
    lines = [line for line in as_markdown(_table()).splitlines() if line.startswith("|")]
    assert {len(re.findall(r"(?<!\\)\|", line)) for line in lines} == {3}
    assert lines[1] == "| :-- | --: |"
    assert "52.8 [50, 56] ▲" in lines[2]


def test_latex_escapes_what_it_must_and_marks_by_weight():
    text = as_latex(_table())
    assert r"\textbf{52.8 [50, 56]}" in text
    assert r"\underline{$\leq$ 32}" in text
    assert r"\begin{tabular}{lr}" in text
    assert r"a$|$b $<$i$>$ \& 50\% of\_\{x\} \textbackslash{} \textasciitilde{}\textasciicircum{}\#\$" in text
    assert text.count(r"\\") == 3
    braces = re.sub(r"\\[{}]", "", text)
    assert braces.count("{") == braces.count("}")


def test_a_row_of_another_length_is_refused():
    with pytest.raises(InvalidValue, match="row of 1"):
        _table(rows=((Entry("x"),),))
