import pytest

from tests.studies.report.stores import made_up, solved, task, write_store
from tests.studies.report.stores import without_pictures as without_pictures

pytestmark = pytest.mark.usefixtures("without_pictures")


def test_a_report_is_written_and_summed_up_within_100_columns(run, tmp_path):
    rows = made_up("maze-1", runs=20) + made_up("chain-10d", runs=20, rule="k=10 earlier", search="stock")
    write_store(tmp_path / "results.db", rows)
    code, out, err = run("report", "results.db", "-o", "out/")
    assert (code, err) == (0, "")
    assert (tmp_path / "out" / "report.html").is_file()
    assert "maze-1" in out
    assert "Table 1 of the paper:" in out
    assert "out/report.html" in out
    assert max(map(len, out.splitlines())) <= 100
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "evenroad report results.db -o out" in page


@pytest.mark.parametrize("width", [80, 100, 200])
def test_every_row_stays_on_its_line(run, tmp_path, monkeypatch, width):
    monkeypatch.setenv("COLUMNS", str(width))
    rates = {"uniform": (0.0, 0.1, 0.5), "halton paper-blocks": (0.5, 0.95, 1.0)}
    rows = made_up("corridor-10d-0.495", rates=rates, counts=(1024, 2048, 4096), rule="radius* gamma=638")
    rows += [
        (task("fair-balls-3d-50", sampler, 256, each, instance=each, rule=f"k={k} symmetrised"), solved())
        for sampler in ("uniform", "korobov")
        for k in (4, 6, 10, 20)
        for each in range(12)
    ]
    write_store(tmp_path / "results.db", rows)
    _, out, _ = run("report", "results.db", "-o", "out")
    lines = [line.rstrip() for line in out.splitlines()]
    assert max(map(len, lines)) <= min(width, 100)
    (row,) = [line for line in lines if line.startswith("corridor-10d-0.495")]
    assert row.endswith(": halton paper-blocks")
    assert ("240" in row.split()) == (width >= 100)
    assert "Fair suite, k=4, 6, 10, 20 symmetrised: success minus uniform's [points]" in lines


def test_rows_that_wait_for_the_store_are_named(run, tmp_path):
    store = tmp_path / "results.db"
    write_store(store, made_up("maze-1", runs=3))
    (tmp_path / "results.db.rescue").touch()
    code, out, _ = run("report", "results.db", "-o", "out")
    assert code == 0
    assert "not in it: the rows in" in " ".join(out.split())


def test_only_some_problems_may_be_asked_for(run, tmp_path):
    write_store(tmp_path / "results.db", made_up("maze-1", runs=5) + made_up("maze-2", runs=5))
    code, out, _ = run("report", "results.db", "-o", "out", "--only", "maze-2,")
    assert code == 0
    assert "maze-1" not in out
    assert not (tmp_path / "out" / "expected.csv").exists()


@pytest.mark.parametrize(("arguments", "text"), [
    (("none.db", "-o", "out"), "no such store: none.db"), (("empty.db", "-o", "out"), "no rows"),
    (("text.db", "-o", "out"), "text.db"),
    (("results.db", "-o", "no/such/folder"), "no/such does not exist"),
    (("results.db", "-o", "out", "--only", "m" * 5000), "unknown problem in results.db: 'mmm"),
    (("results.db", "-o", "out", "--only", "maze-7"), "unknown problem in results.db: 'maze-7'; did you mean 'maze-1'"),
])  # fmt: skip
def test_bad_input_is_one_line_and_exit_code_2(run, tmp_path, arguments, text):
    write_store(tmp_path / "results.db", [(task(), solved())])
    write_store(tmp_path / "empty.db", [])
    (tmp_path / "text.db").write_text(
        "not a store, but a text that is long enough to have a header of a hundred bytes" * 2
    )
    code, out, err = run("report", *arguments)
    assert (code, out) == (2, "")
    assert text in err
    assert len(err.splitlines()) == 1
    assert len(err) < 300
