"""The report of a corpus: what it says needs a look, its figures and bars, and what of it a user can do."""

import base64
import hashlib
import html
import itertools
import json
import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import report_models
from corpus.carried_files import MOST, list_carried
from corpus.configuration import check_config
from reebslice.drawing.report_charts import HEIGHT, draw_chart, split_values
from reebslice.drawing.report_figures import FIGURES, list_figures
from reebslice.drawing.report_looks import MATTERS, find_looks
from reebslice.drawing.report_words import write_looks
from reebslice.drawing.verdicts import shorten_numbers
from test_pages import BROWSER, NASTY, Reader, browse

SCHEMA = yaml.safe_load((Path(report_models.__file__).parents[1] / "schemas" / "config.schema.yaml").read_text())
STAGES = ("inspect_mesh", "draw", "view", "certify")
OPEN = "The surface is open: {} mesh edges have only one face, the first from ({}, 0.5, 1). Fill the holes of '{}'."
DOT = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


def make_rows(count):
    """Rows of a table of models: of every seventh one the mesh is open, of every eleventh a check fails, and so on."""
    rows = []
    for k in range(count):
        row = {"model": f"part_{k:04d}", "path": f"meshes/part_{k:04d}.stl", "status": "ok", "reason": ""}
        row |= {"verdict": "exact" if k % 2 else "exact_at_feature_size", "genus": k % 5, "volume": 1.5 * k + 1}
        row |= {"n_faces": 1001 * 3 ** (k % 10), "unit": "millimetre" if k % 3 else None, "self_crossings": 0}
        row |= {"seconds_inspect_mesh": 0.25 * k, "seconds_draw": 1.0, "peak_memory_mb_inspect_mesh": 150.0 + k % 4}
        row |= {"peak_memory_mb_draw": 152.0, "hidden_genus": 0}
        if k % 7 == 3:
            row |= {"status": "rejected", "verdict": "rejected", "genus": None, "volume": None, "seconds_draw": None}
            row["reason"] = OPEN.format(k + 2, k + 0.12345678901234567, f"part_{k:04d}")
        elif k % 11 == 5:
            row |= {"verdict": "uncertified", "reason": f"The check 'genus' fails: Handle {k} is the first."}
        elif k % 13 == 6:
            row |= {
                "status": "failed",
                "verdict": None,
                "reason": f"draw: {row['path']}: memory ran out",
                "genus": None,
            }
        elif k % 17 == 4:
            row |= {"self_crossings": k, "solid_interpretation": f"The surface crosses itself at {k} pairs."}
        rows.append(row)
    return rows


def make_page(folder, rows, monkeypatch):
    """Write the report of models, with files for those that are ok, and return its path."""
    monkeypatch.chdir(folder)
    for row in rows:
        own = Path("results/models") / row["model"]
        own.mkdir(parents=True)
        names = ["inspection.json"]
        names += ["view.html", "picture.png", "thumbnail.png", "certificate.json"] if row["status"] == "ok" else []
        for name in names:
            (own / name).write_bytes(DOT)
    config = check_config({"meshes": "my <b>meshes</b>"}, SCHEMA)
    page = folder / "results/corpus/report.html"
    page.parent.mkdir()
    page.write_text(report_models.main(pa.Table.from_pylist(rows), config, 2, STAGES))
    return page


def test_a_report_of_some_models_says_what_picked_them(tmp_path, monkeypatch):
    page = make_page(tmp_path, make_rows(2), monkeypatch)
    assert "picks, by verdict" not in page.read_text()
    config = check_config({"meshes": "meshes", "only": ["a<b", "c*"]}, SCHEMA)
    told = report_models.main(pa.Table.from_pylist(make_rows(2)), config, 0, STAGES)
    assert "that <code>only=[&#x27;a&lt;b&#x27;, &#x27;c*&#x27;]</code> picks, by verdict" in told


def test_names_within_other_words_do_not_split_a_reason():
    reason = "the surface is open in 'meshes/{0}.stl', near {0}"
    rows = [{"status": "rejected", "verdict": "rejected", "reason": reason.format(name), "model": name,
             "path": f"meshes/{name}.stl"} for name in ("a", "e", "part")]  # fmt: skip
    assert [look.models for look in find_looks(rows)] == [[0, 1, 2]]


def test_a_reason_that_all_models_have_to_the_letter_is_not_said_to_be_of_the_first():
    reasons = ["The file is empty.", "The file is empty.", "1 hole", "2 holes", "3 holes"]
    rows = [{"status": "rejected", "verdict": "rejected", "reason": reason, "model": f"m{k}", "path": f"m{k}.stl"}
            for k, reason in enumerate(reasons)]  # fmt: skip
    told = write_looks(find_looks(rows), [row["model"] for row in rows], [None] * 5)
    assert told.count("numbers and names: of") == 1 and "numbers and names: of m3" in told


def read_data(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page.read_text(), re.DOTALL)[1])


# ---------------------------------------------------------------- what needs a look


def test_models_are_grouped_by_what_is_the_matter_with_them():
    rows = make_rows(200)
    looks = find_looks(rows)
    assert [look.matter for look in looks] == ["failed", "rejected", "uncertified", "crossing"]
    kinds = {"failed": "failed", "rejected": "rejected", "uncertified": "uncertified"}
    for look in looks[:3]:
        told = [k for k, row in enumerate(rows) if kinds[look.matter] in (row["status"], row["verdict"])]
        assert look.models == told  # reasons of one kind differ in names, paths and numbers alone
    assert looks[3].models == [
        k for k, row in enumerate(rows) if row["self_crossings"] and row["verdict"].startswith("exact")
    ]
    assert looks[1].reason == OPEN.format(5, "3.12346", "part_0003")


def test_other_reasons_are_other_looks_the_largest_first_and_what_is_proven_may_have_a_note():
    ends = [("rejected", "rejected", f"hole {k}") for k in range(3)] + [("rejected", "rejected", "a crack")]
    ends += [("ok", "exact", ""), ("ok", "exact", "no pockets were looked for: too many"), ("skipped", None, "")]
    rows = [dict(zip(("status", "verdict", "reason"), end), model=f"m{k}", path="") for k, end in enumerate(ends)]
    rows[4] |= {
        "void_verdict": "uncertified",
        "void_reason": "0.30000000000000004 is open",
        "hidden_genus": 2,
        "genus": 9,
    }
    rows[4] |= {"function_verdicts_geodesic": "exact"}
    rows[5] |= {"function_verdicts_geodesic": "rejected", "function_verdicts_barycentre": None}
    assert [(look.matter, look.reason, look.models) for look in find_looks(rows)] == [
        ("rejected", "hole 0", [0, 1, 2]),
        ("rejected", "a crack", [3]),
        ("skipped", "", [6]),
        ("hidden", "2 of 9 loops lie between two levels.", [4]),
        ("void", "0.3 is open", [4]),
        ("function", "geodesic: rejected", [5]),
        ("note", "no pockets were looked for: too many", [5]),
    ]
    assert all(len(words) == 2 and all(words) for words in MATTERS.values())


@given(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from(["", "(", " from ", "="]),
    st.sampled_from([",", ")", ". A", ""]),
)
def test_numbers_are_as_near_as_six_digits_and_words_stay(number, before, after):
    told = shorten_numbers(f"part_1.50000000{before or ' '}{number!r}{after}")
    start, end = f"part_1.50000000{before or ' '}", after
    assert told.startswith(start) and told.endswith(end)
    shown = told[len(start) : len(told) - len(end)]
    assert float(shown) == pytest.approx(number, rel=5e-6) and len(shown) <= max(13, len(f"{number:.6g}"))


# ---------------------------------------------------------------- figures and bars


def test_figures_are_those_of_the_table_seconds_summed_and_memory_the_largest():
    rows = make_rows(60)
    figures = {figure.name: values for figure, values in list_figures(pa.Table.from_pylist(rows)).items()}
    assert set(figures) == {
        "genus", "volume", "n_faces", "self_crossings", "hidden_genus", "seconds", "peak_memory_mb"
    }  # fmt: skip
    assert figures["genus"] == [row["genus"] for row in rows]
    for k, row in enumerate(rows):
        assert figures["seconds"][k] == pytest.approx(
            row["seconds_inspect_mesh"] + (row["seconds_draw"] or 0), rel=1e-5
        )
        assert figures["peak_memory_mb"][k] == max(row["peak_memory_mb_inspect_mesh"], 152)
    strange = pa.table({"area": [1.23456789, float("nan"), float("inf"), None], "volume": [float("nan")] * 4})
    assert {figure.name: values for figure, values in list_figures(strange).items()} == {"area": [1.23457] + [None] * 3}
    assert len({figure.name for figure in FIGURES}) == len({figure.label for figure in FIGURES}) == len(FIGURES)


numbers = st.one_of(
    st.lists(st.integers(0, 10**7).map(float), min_size=1, max_size=60),
    st.lists(st.floats(-1e6, 1e9, allow_nan=False), min_size=1, max_size=60),
)


@given(numbers)
def test_every_value_is_counted_by_one_bar(values):
    values = np.sort(np.array(values))
    bins = split_values(values)
    assert np.array_equal(np.concatenate(bins), values) and len(bins) <= 19
    full = [own for own in bins if len(own)]
    assert all(one[-1] < other[0] for one, other in itertools.pairwise(full))


def test_bars_of_the_page_count_what_their_limits_choose():
    for figure, values in list_figures(pa.Table.from_pylist(make_rows(300))).items():
        chart = draw_chart(figure, values)
        known = [value for value in values if value is not None]
        bars = re.findall(r'data-low="([^"]*)" data-high="([^"]*)" aria-label="[^"]*: ([\d,]+) models?"', chart)
        assert bool(bars) == (len(set(known)) > 1)
        counts = [int(count.replace(",", "")) for *_, count in bars]
        assert counts == [sum(float(low) <= value <= float(high) for value in known) for low, high, _ in bars]
        assert not bars or sum(counts) == len(known)


@given(numbers)
def test_words_below_bars_differ_and_do_not_cover_each_other(values):
    chart = draw_chart(FIGURES[0], values)
    labels = re.findall(rf'<text x="([\d.]+)" y="{HEIGHT - 5}">([^<]*)</text>', chart)
    assert (len(labels) > 0) == (len(set(values)) > 1)
    for (left, one), (right, other) in itertools.pairwise(labels):
        assert one != other and float(right) - float(left) >= 5.5 * (len(one) + len(other)) / 2


# ---------------------------------------------------------------- the page


def test_texts_from_files_are_text_whatever_they_are(tmp_path, monkeypatch):
    plain, nasty = make_rows(40), make_rows(40)
    hostile = NASTY.replace("/", "") + " </script>&amp;"
    for rows, word in ((plain, "word"), (nasty, hostile)):
        for row in rows:
            row["path"] = row["path"].replace("meshes", word)
            row["reason"] += word if row["reason"] else ""
        rows[3]["model"] = word.replace("/", "") + "!"
    pages = []
    for name, rows in (("plain", plain), ("nasty", nasty)):
        (tmp_path / name).mkdir()
        pages.append(make_page(tmp_path / name, rows, monkeypatch))
    plain, nasty = (Reader(page.read_text()) for page in pages)
    assert [tag for tag, _ in plain.elements] == [tag for tag, _ in nasty.elements]
    assert hostile in "".join(nasty.texts["p"]) and "my <b>meshes</b>" in "".join(nasty.texts["code"])
    assert hostile.replace("/", "") + "!" in read_data(pages[1])["models"]


def test_the_page_loads_nothing_but_thumbnails_and_runs_only_what_it_brings(tmp_path, monkeypatch):
    page = make_page(tmp_path, make_rows(40), monkeypatch)
    text = page.read_text()
    read = Reader(text)
    links = [attrs[key] for _, attrs in read.elements for key in ("src", "href", "data", "action") if key in attrs]
    assert set(links) >= {"data:,", "models.parquet"}
    for link in set(links) - {"data:,"}:
        assert (page.parent / link).exists() or link == "models.parquet", link
    assert not [key for _, attrs in read.elements for key in attrs if key.startswith("on") or key == "style"]
    (code,) = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}';" in text and "default-src 'none'" in text
    assert "innerHTML" not in code and "eval(" not in code


def test_few_thumbnails_are_in_the_page_and_many_beside_it(tmp_path, monkeypatch):
    rows = make_rows(12)
    monkeypatch.setattr(report_models, "HELD", 12)
    data = read_data(make_page(tmp_path, rows, monkeypatch))
    held = [base64.b64encode(DOT).decode() if row["status"] == "ok" else None for row in rows]
    assert data["thumbnails"] == held
    monkeypatch.setattr(report_models, "HELD", 11)
    (tmp_path / "more").mkdir()
    data = read_data(make_page(tmp_path / "more", rows, monkeypatch))
    assert data["thumbnails"] == [int(row["status"] == "ok") for row in rows]


def test_what_other_configurations_left_is_not_linked(tmp_path, monkeypatch):
    rows = make_rows(4)
    make_page(tmp_path, rows, monkeypatch)
    page = report_models.main(pa.Table.from_pylist(rows), check_config({}, SCHEMA), 0, ("inspect_mesh",))
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    names = [name for name, _ in data["linked"]]
    assert set(data["files"]) == {1 << names.index("inspection.json")}
    assert not any(data["thumbnails"])


def test_the_same_table_makes_the_same_bytes_with_versions_and_configuration(tmp_path, monkeypatch):
    rows = make_rows(30)
    text = make_page(tmp_path, rows, monkeypatch).read_text()
    config = check_config({"meshes": "my <b>meshes</b>"}, SCHEMA)
    assert report_models.main(pa.Table.from_pylist(rows), config, 2, STAGES) == text
    told = html.unescape(re.search(r"<pre[^>]*>(.*?)</pre>", text, re.DOTALL)[1])
    assert yaml.safe_load(told) == config and "2 models of the sheet" in text
    assert f'<th scope="row">numpy</th><td>{np.__version__}</td>' in text


def test_a_report_of_snakemake_carries_what_fits(tmp_path, monkeypatch):
    rows = make_rows(9)
    make_page(tmp_path, rows, monkeypatch)
    models = [row["model"] for row in rows]
    ok = [row["model"] for row in rows if row["status"] == "ok"]
    assert list_carried([*models, "{x}"], "report.html")[0] == [
        (f"results/models/{model}/{name}", model, called, f"{called}.rst")
        for model in ok
        for name, called in (("view.html", "page"), ("picture.png", "picture"))
    ]
    with open(f"results/models/{ok[0]}/view.html", "wb") as large:
        large.truncate(int(MOST))  # sparse
    (Path("results/models") / "{x}").mkdir()
    (Path("results/models") / "{x}" / "view.html").write_bytes(DOT)
    assert list_carried(["{x}"], "report.zip") == ([], 1)
    files, left = list_carried(models, "report.html")
    assert left == 1 and {model for _, model, *_ in files} == set(ok[1:])
    assert list_carried(models, "report.zip")[1] == 0


# ---------------------------------------------------------------- in a browser

USER = """
const seen = {};
const names = () => all("#table tbody .name").map((name) => name.textContent);
const column = (name) => {
  const place = all("#table thead button").findIndex((button) => button.dataset.sort === name);
  return all("#table tbody tr").map((row) => row.cells[place].textContent);
};
const click = (selector) => find(selector).dispatchEvent(new MouseEvent("click", { bubbles: true }));
const type = (selector, value) => {
  find(selector).value = value;
  find(selector).dispatchEvent(new Event("input", { bubbles: true }));
};
const note = (name, more = {}) => (seen[name] = { count: find("#count").value, names: names(), ...more });
note("start", { images: all("#table img").length, sort: find("[aria-sort]").textContent });
click('[data-sort="n_faces"]');
note("faces", { faces: column("n_faces"), focus: document.activeElement.dataset.sort });
click('[data-sort="n_faces"]');
note("faces up", { faces: column("n_faces"), sort: find("[aria-sort]").getAttribute("aria-sort") });
type("#search", "PART_01 open");
note("search");
type("#search", "");
find("#kinds input").click();
note("without the first verdict");
find("#kinds input").click();
const bar = all('#charts g[data-figure="genus"]')[2];
bar.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
note("bar", { genus: column("genus"), pressed: all('[aria-pressed="true"]').length });
bar.dispatchEvent(new KeyboardEvent("keydown", { key: " ", bubbles: true }));
note("bar again", { pressed: all('[aria-pressed="true"]').length });
click('[data-sort="model"]');
click('[data-go="1"]');
note("next");
click('[data-look="1"]');
note("look");
click("#all");
setTimeout(() => {
  note("all again");
  find('#columns input[value="volume"]').click();
  seen.volumes = column("volume");
  seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const report = document.createElement("pre");
  report.id = "seen";
  report.textContent = JSON.stringify(seen);
  document.body.append(report);
}, 50);
"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_rows_are_sorted_searched_and_chosen_by_bars_and_looks(tmp_path, monkeypatch):
    rows = make_rows(200)
    page = make_page(tmp_path, rows, monkeypatch)
    digest = base64.b64encode(hashlib.sha256(USER.encode()).digest()).decode()
    text = page.read_text().replace("script-src ", f"script-src 'sha256-{digest}' ", 1)
    used = page.with_name("used.html")
    used.write_text(text.replace("</body>", f"<script>{USER}</script></body>"))
    dom, console = browse("--dump-dom", used.as_uri())
    assert console == []
    seen = json.loads(html.unescape(re.search(r'<pre id="seen">(.*?)</pre>', dom)[1]))
    kinds = [row["status"] if row["status"] == "failed" else row["verdict"] for row in rows]
    order = ["failed", "rejected", "uncertified", "exact_at_feature_size", "exact"]
    first = sorted(range(200), key=lambda k: order.index(kinds[k]))
    assert seen["start"]["names"] == [rows[k]["model"] for k in first[:50]]
    assert seen["start"]["count"] == "200 of 200 models, 1 to 50 here" and seen["start"]["sort"].startswith("verdict")
    assert seen["start"]["images"] == sum(rows[k]["status"] == "ok" for k in first[:50])
    faces = sorted((row["n_faces"] for row in rows), reverse=True)
    assert seen["faces"]["faces"] == [f"{value:,}" for value in faces[:50]] and seen["faces"]["focus"] == "n_faces"
    assert seen["faces up"]["faces"] == [f"{value:,}" for value in faces[::-1][:50]]
    assert seen["faces up"]["sort"] == "ascending"
    found = {row["model"] for row in rows if "part_01" in row["model"] and "open" in row["reason"]}
    assert set(seen["search"]["names"]) == found
    assert seen["without the first verdict"]["count"].startswith(f"{200 - kinds.count('failed')} of 200")
    twos = sum(row["genus"] == 2 for row in rows)
    assert seen["bar"]["count"].startswith(f"{twos} of 200") and set(seen["bar"]["genus"]) == {"2"}
    assert seen["bar"]["pressed"] == 1 and seen["bar again"]["pressed"] == 0
    assert seen["bar again"]["count"].startswith("200 of 200")
    assert seen["next"]["names"] == [f"part_{k:04d}" for k in range(50, 100)]
    rejected = [row["model"] for row in rows if row["verdict"] == "rejected"]
    assert seen["look"]["names"] == rejected and "with the same reason" in seen["look"]["count"]
    assert seen["all again"]["count"].startswith("200 of 200 models, ")
    assert seen["volumes"][1] == "2.5\u00a0mm\u00b3" and seen["volumes"][0] == "1"
    assert seen["wide"] <= 0


PHONE = """
const page = document.documentElement;
const lines = (text) => {
  const range = document.createRange();
  range.selectNodeContents(text);
  return new Set([...range.getClientRects()].map((box) => box.top)).size;
};
const names = all(".name, .names a, .model small:nth-of-type(1)").flatMap((name) => [...name.childNodes]);
const figures = all("#table td.number");
const [first] = all("#table details").map((box) => box.getBoundingClientRect().height);
find("#table details").open = true;
const whole = find("#table details").getBoundingClientRect().height;
const seen = {
  wide: page.scrollWidth - page.clientWidth,
  broken: names.filter((text) => text.nodeType === 3 && lines(text) > 1).map((text) => text.data),
  names: names.length,
  labels: [...new Set(figures.map((cell) => getComputedStyle(cell, "::before").content))],
  beyond: figures.filter((cell) => cell.getBoundingClientRect().right > page.clientWidth).length,
  grows: whole - first,
};
parent.postMessage(JSON.stringify(seen), "*");
"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_on_a_phone_all_of_the_page_is_within_its_width_and_no_word_is_broken(tmp_path, monkeypatch):
    rows = make_rows(60)
    rows[3] |= {"model": "a_long_name-of_some_part-of_a_machine_with_a_number_0003"}
    rows[3] |= {
        "path": f"meshes/{rows[3]['model']}.stl",
        "reason": rows[3]["reason"] + " Or turn its faces around." * 9,
    }
    page = make_page(tmp_path, rows, monkeypatch)
    digest = base64.b64encode(hashlib.sha256(PHONE.encode()).digest()).decode()
    text = page.read_text().replace("script-src ", f"script-src 'sha256-{digest}' ", 1)
    page.write_text(text.replace("</body>", f"<script>{PHONE}</script></body>"))
    phone = page.with_name("phone.html")  # as narrow a window cannot be had
    told = "<script>onmessage = (event) => (document.title = event.data)</script>"
    phone.write_text(
        f'<title></title>{told}<iframe src="{page.name}" width="390" height="800" frameborder="0"></iframe>'
    )
    dom, console = browse("--dump-dom", "--allow-file-access-from-files", phone.as_uri())
    assert console == []
    seen = json.loads(html.unescape(re.search("<title>(.*?)</title>", dom)[1]))
    assert seen["wide"] == 0 and seen["broken"] == [] and seen["names"] > 60
    assert len(seen["labels"]) == 3 and '"genus\xa0"' in [label.replace("\u00a0", "\xa0") for label in seen["labels"]]
    assert seen["beyond"] == 0
    assert seen["grows"] > 10, "a long reason is folded until it is opened"


def test_words_are_told_from_their_ground_in_light_and_in_dark():
    styles = "".join(
        (Path(report_models.__file__).parent / f"reebslice/drawing/{name}.css").read_text()
        for name in ("shared", "report")
    )
    light, dark = styles.split("@media (prefers-color-scheme: dark)")
    inks = dict(re.findall(r"--(\w+): (#\w{6});", light))
    for colours in (inks, inks | dict(re.findall(r"--(\w+): (#\w{6});", dark))):
        for ink, ground in itertools.product(("ink", "soft", "link"), ("ground", "faint", "field")):
            assert contrast(colours[ink], colours[ground]) >= 4.5, (ink, ground)
        assert contrast(colours["bar"], colours["ground"]) >= 3 and contrast(colours["focus"], colours["ground"]) >= 3
    pills = re.findall(r"\.verdict[.\w]* \{[^}]*background: (#\w{6})", light)
    assert len(pills) == 6 and all(contrast("#ffffff", pill) >= 4.5 for pill in pills)


def contrast(one, other):
    """Ratio of luminances by WCAG 2."""
    lights = []
    for colour in (one, other):
        parts = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
        lights.append(
            np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722]
        )
    return (max(lights) + 0.05) / (min(lights) + 0.05)
