"""Opens pages of `mmxrt view` in Chromium, uses them as people do, and compares what they show with NumPy's reading of the files.

    python3 .ci/view_in_chromium.py MMXRT PRODUCT [PICTURES]

PRODUCT has cube.img in BSQ and f32. With PICTURES, a folder, screenshots are written there. Needs playwright, numpy and pillow.
"""

import base64
import io
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

MMXRT, PRODUCT = sys.argv[1], pathlib.Path(sys.argv[2])
PICTURES = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None


def field(header, key):
    return int(re.search(rf"^{key}\s*=\s*(\d+)", header.read_text(), re.M).group(1))


def image(name):
    """[band, line, sample] of an ENVI image of f32 or f64, band by band."""
    header = PRODUCT / f"{name}.hdr"
    kind = {4: "<f4", 5: "<f8"}[field(header, "data type")]
    shape = tuple(field(header, key) for key in ("bands", "lines", "samples"))
    return np.memmap(PRODUCT / f"{name}.img", kind, "r", shape=shape)


def viewed(page):
    """Writes the page; says what that took."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    said = subprocess.run([MMXRT, "view", PRODUCT, "-o", page, "--force", "--json", "--quiet"], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    # The largest child yet: this is the only one so far.
    print(f"  mmxrt view: {time.monotonic() - begun:.1f} s, {cpu:.1f} CPU s, at most {after.ru_maxrss / 1024:.0f} MiB; page of {page.stat().st_size / 1e6:.1f} MB")
    return said


def means(plane, side):
    """Means over cells, those at the edges of fewer pixels."""
    lines, samples = plane.shape
    sums = np.add.reduceat(np.add.reduceat(plane.astype(float), np.arange(0, lines, side), 0), np.arange(0, samples, side), 1)
    counts = np.outer(np.diff(np.r_[np.arange(0, lines, side), lines]), np.diff(np.r_[np.arange(0, samples, side), samples]))
    return sums / counts


def stretched(values, shown):
    """Grey as the documentation says: from the 0.5th to the 99.5th percentile, with the power that makes the median mid-grey."""
    ordered = np.sort(values[shown])
    black, median, white = (ordered[int(share * (len(ordered) - 1) + 0.5)] for share in (0.005, 0.5, 0.995))
    share = (median - black) / (white - black)
    power = max(np.log(0.5) / np.log(share), 1 / 3) if share < 0.5 else 1
    return np.floor(255 * np.clip((values - black) / (white - black), 0, 1) ** power + 0.5)


def canvas(tab):
    """The image as it is drawn: [line, sample, red green blue opacity]."""
    data = tab.evaluate("document.getElementById('image').toDataURL()")
    return np.array(Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGBA"))


def near(shown, wanted, what, within=1):
    away = np.abs(shown[..., 0].astype(float) - wanted)
    assert shown.shape[:2] == wanted.shape and away.max() <= within, f"{what}: up to {away.max()} of 255 off"
    print(f"  {what}: {(away > 0).sum()} of {away.size} pixels are a step off")


def rows(tab):
    """Numbers of the table of all bands."""
    cells = tab.evaluate("[...document.querySelectorAll('#spectrum-table tbody tr')].map(r => [...r.cells].map(c => Number(c.textContent)))")
    return np.array(cells)


def click(tab, sample, line, to=None, shift=False):
    """Clicks in the middle of a pixel, or drags to another."""
    box, (columns, lines) = tab.locator("#image").bounding_box(), tab.evaluate("page.size")
    place = lambda x, y: (box["x"] + (x + 0.5) / columns * box["width"], box["y"] + (y + 0.5) / lines * box["height"])
    if shift:
        tab.keyboard.down("Shift")
    tab.mouse.move(*place(sample, line))
    tab.mouse.down()
    if to:
        tab.mouse.move(*place(*to), steps=4)
    tab.mouse.up()
    if shift:
        tab.keyboard.up("Shift")
    settled(tab)


def settled(tab):
    """Waits until what was asked for is shown."""
    tab.evaluate("Promise.all([show(), readout()])")


def check(tab, page):
    cube, thermal = image("cube"), image("thermal") if (PRODUCT / "thermal.img").exists() else None
    bands, lines, samples = cube.shape
    planes = image("backplanes")
    covered = planes[0] > 0
    begun = time.monotonic()
    tab.goto(page.as_uri(), wait_until="commit")
    tab.wait_for_function("() => performance.getEntriesByName('first picture').length > 0", polling=20)
    first = tab.evaluate("performance.getEntriesByName('first picture')[0].startTime") / 1000
    print(f"  first picture: {first:.2f} s after the page was asked for ({time.monotonic() - begun:.2f} s seen from outside)")
    assert first < 2, "the first picture takes too long"
    quick = np.array(Image.open(PRODUCT / "quicklook.png").convert("RGB"))
    shown = canvas(tab)
    assert (shown[..., :3] == quick).all(), "the quick look is not the PNG"
    assert "Coarse" in tab.text_content("#coarse") or tab.evaluate("page.sources.cube.side") == 1

    side = tab.evaluate("page.sources.cube.side")
    at = (samples // 3, lines // 2)
    click(tab, *at)
    tab.click("summary")
    tab.wait_for_selector("#spectrum-table tbody tr")
    cell = [v // side * side for v in at]
    block = (slice(cell[1], cell[1] + side), slice(cell[0], cell[0] + side))
    mean = lambda of: of[:, block[0], block[1]].astype(float).mean((1, 2)).astype(np.float32)
    found = rows(tab)
    assert np.array_equal(found[:, 2].astype(np.float32), mean(cube)), "the spectrum is another one"
    if thermal is not None:
        assert np.array_equal(found[:, 4].astype(np.float32), mean(thermal)), "the thermal part is another one"
        assert np.allclose(found[:, 3], found[:, 2] - found[:, 4], rtol=1e-6)
    text = tab.text_content("#values")
    assert f"sample {at[0]}, line {at[1]}" in text
    print(f"  spectrum at {at}: {bands} bands as in the file (cells of {side} x {side})")

    # The planes' own pixel.
    of = tab.evaluate("page.sources.planes.side")
    middle = lambda v, whole: (v // of * of + min(v // of * of + of, whole)) // 2
    wanted = np.float32(planes[:, middle(at[1], lines), middle(at[0], samples)])
    told = tab.evaluate("page.sources.planes.region(page.selected.a).then(all => all.map(m => m.mean))")
    told = np.array([np.nan if v is None else v for v in told], np.float32)
    assert np.array_equal(told, wanted, equal_nan=True), "planes are others"

    tab.select_option("#layer", "cube")
    for band in (0, bands // 2, bands - 1):
        tab.fill("#band", str(band))
        settled(tab)
        values = means(cube[band], side)
        near(canvas(tab), stretched(values.astype(np.float32), np.ones(values.shape, bool)), f"band {band + 1} through the slider")
    tab.select_option("#layer", "rgb")
    settled(tab)
    of_rgb = tab.evaluate("page.rgb")
    for k, band in enumerate(of_rgb):
        values = means(cube[band], side).astype(np.float32)
        near(canvas(tab)[..., k:], stretched(values, np.ones(values.shape, bool)), f"colour {k + 1} of 3")

    # All pixels, of the file itself.
    tab.set_input_files("#file", [PRODUCT / "cube.img"] + ([PRODUCT / "thermal.img"] if thermal is not None else []))
    tab.wait_for_function("() => page.sources.cube.blob && document.getElementById('coarse').textContent.includes('Full cube')")
    tab.select_option("#layer", "cube")
    tab.fill("#band", str(bands // 3))
    settled(tab)
    near(canvas(tab), stretched(cube[bands // 3].astype(float), covered) * covered, "a band of the full cube")
    click(tab, *at)
    assert np.array_equal(rows(tab)[:, 2].astype(np.float32), cube[:, at[1], at[0]]), "the full spectrum is another one"
    corner, end = (samples // 5, lines // 5), (samples // 5 + 7, lines // 5 + 4)
    click(tab, *corner, to=end, shift=True)
    region = cube[:, corner[1]:end[1] + 1, corner[0]:end[0] + 1].astype(float).reshape(bands, -1)
    found = rows(tab)[:, 5 if thermal is not None else 3:]
    assert np.allclose(found[:, 0], region.mean(1), rtol=1e-7, atol=0) and np.allclose(found[:, 1], region.std(1), rtol=1e-7, atol=0)
    print("  full cube: pixel and region as in the file")


def other_layouts(tab, page, scratch):
    """The same cube in other orders of bytes, dropped with its header."""
    cube = image("cube")
    bands, lines, samples = cube.shape
    for name, axes, kind, code, order in (("bil", (1, 0, 2), "<f8", 5, 0), ("bip", (1, 2, 0), ">f4", 4, 1), ("bsq", (0, 1, 2), ">f8", 5, 1)):
        np.ascontiguousarray(cube.transpose(axes)).astype(kind).tofile(scratch / f"{name}.img")
        (scratch / f"{name}.hdr").write_text(
            f"ENVI\nsamples = {samples}\nlines = {lines}\nbands = {bands}\nheader offset = 0\ndata type = {code}\ninterleave = {name}\nbyte order = {order}\n"
        )
        tab.goto(page.as_uri())
        tab.wait_for_function("() => performance.getEntriesByName('first picture').length > 0")
        tab.set_input_files("#file", [scratch / f"{name}.img", scratch / f"{name}.hdr"])
        tab.wait_for_function("() => page.sources.cube.blob")
        found = tab.evaluate("page.sources.cube.region([3, 5, 3, 5]).then(all => all.map(m => m.mean))")
        plane = tab.evaluate("page.sources.cube.plane(7).then(p => Array.from(p))")
        assert np.array_equal(np.float32(found), cube[:, 5, 3]), name
        assert np.array_equal(np.float32(plane).reshape(lines, samples), cube[7]), name
        (scratch / f"{name}.img").unlink()
    print("  BIL, BIP and BSQ of other types and byte orders: as in the file")


def write_envi(path, numbers, more=""):
    """Writes [band, line, sample] as f32, band by band."""
    bands, lines, samples = numbers.shape
    numbers.astype("<f4").tofile(path)
    path.with_suffix(".hdr").write_text(
        f"ENVI\nsamples = {samples}\nlines = {lines}\nbands = {bands}\nheader offset = 0\ndata type = 4\ninterleave = bsq\nbyte order = 0\n{more}"
    )


def limb(folder, count):
    """A product in which a disc is before the sky, with so many planes: its cube, its thermal part, what is covered; two pixels have no data, nine are dark."""
    lines, samples, bands = 96, 90, 20
    y, x = np.mgrid[:lines, :samples]
    covered = (x - 47.3) ** 2 + (y - 44.8) ** 2 < 37**2
    some = np.random.default_rng(1)
    thermal = np.float32(covered * (0.2 + some.random((bands, lines, samples))))
    cube = np.float32(thermal + covered * (0.5 + some.random((bands, lines, samples))))
    for of in (cube, thermal):
        of[:, 30:33, 30:33] = 0
        of[:, 40, 40:42] = -9999.9
    folder.mkdir()
    # This one is no f32.
    for name, of in (("cube", cube), ("thermal", thermal)):
        write_envi(folder / f"{name}.img", of, "data ignore value = -9999.9\n")
    names = ["COVERAGE", "PHASE (deg)", "ABUNDANCE grey (old)", *(f"P{k} (m)" for k in range(count))][:count]
    write_envi(folder / "backplanes.img", np.broadcast_to(np.float32(covered), (count, lines, samples)), f"band names = {{{', '.join(names)}}}\n")
    for of in (cube, thermal):
        of[of == np.float32(-9999.9)] = np.nan
    return cube, thermal, covered


def opens(tab, page):
    tab.goto(page.as_uri())
    tab.wait_for_function("() => performance.getEntriesByName('first picture').length > 0")


def drops(tab, files, said):
    """Gives files to the page, and waits until it says so."""
    tab.set_input_files("#file", files)
    tab.wait_for_function("said => document.getElementById('coarse').textContent.includes(said)", arg=said)
    settled(tab)


def columns(tab):
    """The table of all bands, by what its columns are of."""
    if not tab.evaluate("document.querySelector('#readout details').open"):
        tab.click("summary")
    tab.wait_for_selector("#spectrum-table tbody tr")
    numbers = tab.evaluate("[...document.querySelectorAll('#spectrum-table tbody tr')].map(r => [...r.cells].map(c => Number(c.textContent)))")
    return dict(zip(tab.evaluate("[...document.querySelectorAll('#spectrum-table th')].map(c => c.textContent)"), np.float32(numbers).T))


def no_reflected(tab, missing):
    """Cube and thermal part are of other pixels: nothing on the page is their difference, and it says what is missing."""
    assert "A reflected" not in columns(tab) and "reflected" not in tab.text_content("#legend")
    assert tab.locator("#layer option[value=reflected]").count() == 0
    assert f"The reflected part needs {missing}" in tab.text_content("#coarse")


def one_file_alone(tab, page, product, cube, thermal):
    """The cube without its thermal part, and the other way around, on a page that has means of 2 x 2 pixels."""
    (x, y), cell = (50, 21), (slice(None), slice(20, 22), slice(50, 52))
    means_of = lambda of: of[cell].astype(float).mean((1, 2)).astype(np.float32)
    for dropped, stays, full, coarse in (("cube", "thermal", cube, thermal), ("thermal", "cube", thermal, cube)):
        opens(tab, page)
        tab.select_option("#layer", "reflected")
        click(tab, x, y)
        found = columns(tab)
        assert np.array_equal(found["A value"], means_of(cube)) and np.array_equal(found["A thermal"], means_of(thermal))
        assert np.allclose(found["A reflected"], means_of(cube) - means_of(thermal), rtol=1e-6)
        drops(tab, [product / f"{dropped}.img"], "Full")
        no_reflected(tab, f"{stays}.img")
        assert tab.input_value("#layer") == "cube"
        found = columns(tab)
        columns_of = {"cube": "A value", "thermal": "A thermal"}
        assert np.array_equal(found[columns_of[dropped]], full[:, y, x]) and np.array_equal(found[columns_of[stays]], means_of(coarse))
        note = tab.text_content("#values")
        assert ("thermal part: mean of 2 × 2 pixels" if stays == "thermal" else "spectrum: mean of 2 × 2 pixels; thermal part: all pixels") in note, note
        drops(tab, [product / f"{stays}.img"], f"from {stays}.img")
        found = columns(tab)
        assert np.array_equal(found["A reflected"], cube[:, y, x] - thermal[:, y, x])
        assert "needs" not in tab.text_content("#coarse") and tab.locator("#layer option[value=reflected]").count() == 1
    print("  one file dropped alone: nothing is subtracted from other pixels")


def what_is_sky(tab, page, product, cube, covered, planes_side):
    """Which pixels have a check pattern, of means of 2 x 2 pixels and of all pixels."""
    opens(tab, page)
    assert [tab.evaluate(f"page.sources.{key}.side") for key in ("cube", "planes")] == [2, planes_side]
    tab.select_option("#layer", "cube")
    tab.fill("#band", "5")
    settled(tab)
    cells = lambda of, how: how(of.reshape(48, 2, 45, 2), (1, 3))
    has_data = np.isfinite(cube[5])
    is_seen = covered if planes_side == 1 else has_data & (cube[5] != 0)
    assert np.array_equal(canvas(tab)[..., 3] > 0, cells(is_seen, np.any) & cells(has_data, np.any)), "sky of cells"
    drops(tab, [product / "cube.img"], "Full cube")
    assert ("count as sky" in tab.text_content("#coarse")) == (planes_side > 1)
    assert np.array_equal(canvas(tab)[..., 3] > 0, is_seen & has_data), "sky of pixels"
    near(canvas(tab), stretched(np.nan_to_num(cube[5]).astype(float), is_seen & has_data) * (is_seen & has_data), f"a limb, of which one backplane's pixel in {planes_side} x {planes_side} is known")
    lost = tab.evaluate("page.sources.cube.region([40, 40, 40, 40]).then(all => all.map(m => m.count))")
    assert lost == [0] * len(cube), "no data"


def strange_files(tab, page, product, cube, scratch):
    """Files that are not the page's, or in another layout; and a drag that the system takes over."""
    opens(tab, page)
    write_envi(scratch / "other.img", cube[::-1])
    (scratch / "alone.hdr").write_text("ENVI\n")
    for files, said in (
        ([scratch / "other.img"], "other.img holds other numbers than the cube"),
        ([product / "thermal.img", product / "cube.hdr", scratch / "other.img"], "other.img holds other numbers than the cube"),
        ([scratch / "alone.hdr"], "alone.hdr is a header"),
    ):
        drops(tab, files, said)
        assert not tab.evaluate("Boolean(page.sources.cube.blob || page.sources.thermal.blob)"), "taken all the same"
    numbers = np.nan_to_num(cube, nan=-9999.9)
    numbers.transpose(1, 0, 2).astype("<f4").tofile(scratch / "bil.dat")
    bands, lines, samples = cube.shape
    # A key without a value is none, and does not take the next line.
    header = f"ENVI\r\nsamples = {samples}\r\nlines = {lines}\r\nbands = {bands}\r\nheader offset =\r\ndata type = 4\r\nmap info =\r\ninterleave = bil\r\ndata ignore value = -9999.9\r\n"
    (scratch / "bil.hdr").write_text(header, newline="")
    drops(tab, [scratch / "bil.dat", scratch / "bil.hdr"], "Full cube")
    found = tab.evaluate("page.sources.cube.plane(7).then(p => Array.from(p, v => isNaN(v) ? null : v))")
    assert np.array_equal(np.float32([np.nan if v is None else v for v in found]).reshape(lines, samples), cube[7], equal_nan=True)
    for layer, unit in (("plane 1", "deg"), ("plane 2", ""), ("plane 3", "m")):
        tab.select_option("#layer", layer)
        settled(tab)
        assert tab.text_content("#unit") == unit, layer
    click(tab, 3, 5)
    box = tab.locator("#image").bounding_box()
    tab.mouse.move(box["x"] + 20, box["y"] + 20)
    tab.mouse.down()
    tab.evaluate("document.getElementById('image').dispatchEvent(new PointerEvent('pointercancel'))")
    tab.mouse.move(box["x"] + 60, box["y"] + 60)
    tab.mouse.up()
    settled(tab)
    assert tab.evaluate("page.selected.a") == [3, 5, 3, 5]
    print("  other files are refused, other layouts read; a drag that is cancelled marks nothing")


def small_products(tab, scratch):
    for count, side in ((1, 1), (60, 3)):
        product, page = scratch / f"limb_{count}", scratch / f"limb_{count}.html"
        cube, thermal, covered = limb(product, count)
        subprocess.run([MMXRT, "view", product, "-o", page, "--budget", "1", "--quiet"], check=True)
        what_is_sky(tab, page, product, cube, covered, side)
        one_file_alone(tab, page, product, cube, thermal)
    strange_files(tab, page, product, cube, scratch)


def main():
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if not chromium:
        print("SKIPPED: chromium is not installed")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        folder = pathlib.Path(folder)
        page = folder / "page.html"
        viewed(page)
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        wrong = []
        for size, scheme in (((1280, 800), "light"), ((1600, 1000), "dark"), ((1280, 800), "dark"), ((1600, 1000), "light")):
            tab = browser.new_page(viewport={"width": size[0], "height": size[1]}, color_scheme=scheme)
            tab.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
            tab.on("pageerror", lambda error: wrong.append(str(error)))
            tab.on("request", lambda asked: wrong.append(asked.url) if not asked.url.startswith(("file:", "data:", "blob:")) else None)
            if (size, scheme) == ((1280, 800), "light"):
                check(tab, page)
                if image("cube").nbytes < 200e6:
                    other_layouts(tab, page, folder)
                    small_products(tab, folder)
            tab.goto(page.as_uri())
            tab.wait_for_function("() => performance.getEntriesByName('first picture').length > 0")
            click(tab, *(v // 2 for v in tab.evaluate("page.size")))
            click(tab, 10, 20, to=(40, 60), shift=True)
            if scheme == "light":
                tab.select_option("#layer", "cube" if size[0] < 1500 else "thermal")
                tab.select_option("#map", "viridis" if size[0] > 1500 else "grey")
                settled(tab)
            if PICTURES:
                tab.screenshot(path=PICTURES / f"view_{size[0]}_{scheme}.png")
            tab.close()
        browser.close()
    assert not wrong, json.dumps(wrong, indent=1)
    print("  no error on the console, nothing asked for from elsewhere")


main()
