#!/usr/bin/env python3
"""The page of `pelage compare` in headless Chromium: what a person would do with it, by mouse and keys.

Pages come from comparison_sample (see there how its pictures say which pixel of which method is seen), or with
--page from a real comparison, for the checks that hold for any. Exit code 77: no browser here (with CI=true: 1).
"""

import argparse
import os
import subprocess
import sys
import unittest
from pathlib import Path

from browser import Browser, Page, decode_png, find_browser

HOSTILE = "</script><img src=x onerror=\"document.title='ran'\"> & 'hair' {{scene}} \ufffd"
DRAWN = ["truth", "satf", "density-map", "density-map-printed", "deep-opacity", "opacity-shadow", "none"]  # blue / 20
WIDTH, HEIGHT = 120, 90
folder = None
browser = None


class Case(unittest.TestCase):
    page_file = "still.html"

    def open(self, name=None, **how):
        self.page = Page(browser, **how)
        self.addCleanup(self.page.close)
        self.page.open(folder / (name or self.page_file))
        return self.page

    def stage(self):
        return self.page.box("#stage")

    def seen(self, x, y):
        """(pixel's x, pixel's y, method, layer) seen at a place of the window."""
        red, green, blue = self.page.pixel(x, y)
        return red // 2, green // 2, DRAWN[blue // 20], {0: "picture", 5: "error", 10: "flip"}[blue % 20]

    def seen_at(self, across, down):
        """The same at a share of the stage."""
        left, top, width, height = self.stage()
        return self.seen(left + across * width, top + down * height)

    def methods_across(self, down=0.9):
        """Methods seen from left to right in a line of the stage, each with the number of pixels it covers."""
        left, top, width, height = self.stage()
        found = []
        for pixel in self.page.pixels(round(left), round(top + down * height), round(width), 1)[0]:
            if pixel[2] % 20 != 0 or pixel[1] // 2 not in range(round(down * HEIGHT) - 2, round(down * HEIGHT) + 3):
                continue  # the split's line
            method = DRAWN[pixel[2] // 20]
            if not found or found[-1][0] != method:
                found.append([method, 0])
            found[-1][1] += 1
        return found


class Loading(Case):
    def test_nothing_is_written_to_the_console_and_nothing_is_fetched(self):
        for name in ("still.html", "moving.html"):
            page = self.open(name)
            self.assertEqual(page.complaints(), [])
            self.assertFalse(page.evaluate("document.querySelector('#viewer').hidden"))

    def test_a_name_that_is_html_is_shown_as_text_and_runs_nothing(self):
        page = self.open()
        self.assertEqual(page.evaluate("document.querySelector('h1').textContent"), HOSTILE)
        self.assertIn(HOSTILE, page.evaluate("document.title"))
        self.assertEqual(page.evaluate("document.querySelector('#b option:nth-child(4)').textContent"), HOSTILE)
        self.assertIn(HOSTILE, page.evaluate("document.querySelector('#provenance code').textContent"))
        self.assertEqual(page.evaluate("document.querySelectorAll('img[onerror], img[src=x]').length"), 0)
        self.assertEqual(page.evaluate("document.querySelectorAll('script').length"), 1)

    def test_it_is_no_blank_sheet_in_light_and_dark_wide_and_narrow(self):
        for width in (1280, 700):
            for dark in (False, True):
                page = self.open("moving.html", width=width, dark=dark)
                name = f"screenshot-{width}-{'dark' if dark else 'light'}.png"
                page.screenshot(folder / name, whole=True)
                rows = page.pixels(0, 0, width, 900, scale=0.25)
                colours = {pixel for row in rows for pixel in row}
                self.assertGreater(len(colours), 1000, name)
                self.assertEqual(sum(rows[-1][0]) < 384, dark, "the paper's colour")
                self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth"), width, "nothing sticks out")

    def test_curves_are_there_where_hair_moves_and_only_there(self):
        self.assertEqual(self.open("still.html").evaluate("document.querySelectorAll('svg .curve').length"), 0)
        page = self.open("moving.html")
        self.assertEqual(page.evaluate("document.querySelectorAll('svg').length"), 3)
        self.assertEqual(page.evaluate("document.querySelectorAll('svg .curve').length"), 3 * (len(DRAWN) - 1))
        self.assertNotIn("NaN", page.evaluate("document.querySelector('#frames').innerHTML"))


class WithoutScript(Case):
    def test_table_pictures_bars_and_commands_are_there(self):
        page = self.open("moving.html", script=False)
        self.assertFalse(page.evaluate("document.querySelector('#viewer').checkVisibility()"))
        self.assertEqual(page.evaluate("document.querySelectorAll('tbody tr').length"), len(DRAWN) + 1)
        self.assertTrue(page.evaluate("document.querySelector('table').checkVisibility()"))
        shown = "[...document.querySelectorAll('.gallery img')].filter(i => i.checkVisibility() && i.naturalWidth === %d && " \
                "i.getBoundingClientRect().width > 50).length" % WIDTH
        self.assertEqual(page.evaluate(shown), 3 * len(DRAWN) - 2)  # the truth has no maps
        self.assertEqual(page.evaluate("document.querySelectorAll('figcaption').length"), 3 * len(DRAWN) - 2 + 3)
        self.assertEqual(page.evaluate("document.querySelectorAll('.bar-row').length"), len(DRAWN))
        self.assertEqual(page.evaluate("document.querySelectorAll('svg').length"), 3)
        self.assertIn("OpenGL 4.5 is <not> here", page.evaluate("document.querySelector('tr.failed').textContent"))
        self.assertEqual(page.complaints(), [])


class Slider(Case):
    def split_of(self):
        """Where the pictures meet, as seen, and where the handle says, as shares of the width."""
        across = self.methods_across()
        total = sum(count for _, count in across)
        return across[0][1] / total, self.page.evaluate("+document.querySelector('#split').getAttribute('aria-valuenow')") / 100

    def test_it_begins_in_the_middle_with_the_truth_on_the_left(self):
        self.open()
        self.assertEqual([m for m, _ in self.methods_across()], ["truth", "satf"])
        self.assertAlmostEqual(self.split_of()[0], 0.5, delta=0.01)

    def test_the_mouse_moves_it_and_the_pictures_follow(self):
        page = self.open()
        left, top, width, height = self.stage()
        for share in (0.25, 0.8):
            handle = page.box("#split")
            page.drag((handle[0] + handle[2] / 2, top + 0.3 * height), (left + share * width, top + 0.4 * height))
            seen, said = self.split_of()
            self.assertAlmostEqual(seen, share, delta=0.01)
            self.assertAlmostEqual(said, share, delta=0.01)
            handle = page.box("#split")
            self.assertAlmostEqual(handle[0] + handle[2] / 2, left + share * width, delta=2)
        self.assertEqual(page.evaluate("document.querySelectorAll('.inset').length"), 0, "a drag is no click")

    def test_it_stops_at_the_edges(self):
        page = self.open()
        left, top, width, height = self.stage()
        page.drag((left + width / 2, top + 0.3 * height), (left + 3 * width, top + 0.3 * height))
        self.assertEqual([m for m, _ in self.methods_across()], ["truth"])

    def test_arrow_keys_move_it(self):
        page = self.open()
        page.evaluate("document.querySelector('#split').focus()")
        for _ in range(7):
            page.key("ArrowRight")
        self.assertAlmostEqual(self.split_of()[0], 0.57, delta=0.006)
        page.key("ArrowLeft", shift=True)
        self.assertAlmostEqual(self.split_of()[0], 0.47, delta=0.006)
        page.key("Home")
        self.assertEqual([m for m, _ in self.methods_across()], ["satf"])
        page.key("End")
        self.assertEqual([m for m, _ in self.methods_across()], ["truth"])
        self.assertEqual(self.page.evaluate("document.querySelector('#split').getAttribute('aria-valuenow')"), "100")


class Choosing(Case):
    def choose(self, side, id):
        self.page.evaluate(f"(() => {{ const s = document.querySelector('#{side}'); s.value = '{id}';"
                           " s.dispatchEvent(new Event('change', {bubbles: true})); })()")
        self.page.settle()

    def test_the_lists_change_the_pictures(self):
        page = self.open()
        self.choose("a", "none")
        self.choose("b", "density-map-printed")
        self.assertEqual([m for m, _ in self.methods_across()], ["none", "density-map-printed"])
        self.assertEqual(page.evaluate("document.querySelector('#tag-b').textContent"), HOSTILE)
        page.click_on("#swap")
        self.assertEqual([m for m, _ in self.methods_across()], ["density-map-printed", "none"])

    def test_a_method_that_failed_is_no_choice(self):
        page = self.open()
        self.assertEqual(page.evaluate("[...document.querySelectorAll('#a option')].map(o => o.value)"), DRAWN)

    def test_layers(self):
        page = self.open()
        self.choose("a", "none")
        for layer in ("error", "flip", "picture"):
            page.click_on(f"input[value={layer}] + span" if layer != "flip" else "input[name=layer][value=flip] + span")
            self.assertEqual(self.seen_at(0.2, 0.8)[2:], ("none", layer))
            self.assertEqual(self.seen_at(0.8, 0.8)[2:], ("satf", layer))
            self.assertEqual(page.evaluate("document.querySelector('#scale').hidden"), layer == "picture")

    def test_flip_shows_one_picture_at_the_same_place(self):
        page = self.open()
        page.click_on("input[name=mode][value=flip] + span")
        self.assertFalse(page.evaluate("document.querySelector('#split').checkVisibility()"))
        place = self.seen_at(0.3, 0.8)[:2]
        page.key("4")
        self.assertEqual(self.seen_at(0.3, 0.8), (*place, "density-map-printed", "picture"))
        page.evaluate("document.querySelector('#stage').focus()")
        page.key("ArrowDown")
        self.assertEqual(self.seen_at(0.3, 0.8), (*place, "deep-opacity", "picture"))
        page.key("ArrowUp")
        page.key("ArrowUp")
        self.assertEqual(self.seen_at(0.7, 0.8)[2], "density-map")
        page.key("1")
        page.key("ArrowUp")
        self.assertEqual(self.seen_at(0.7, 0.8)[2], "none")
        page.click_on("#list li:nth-child(2) button")
        self.assertEqual(self.seen_at(0.3, 0.8), (*place, "satf", "picture"))
        self.assertEqual([m for m, _ in self.methods_across()], ["satf"])

    def test_space_flips_between_a_and_b(self):
        page = self.open()
        self.choose("a", "deep-opacity")
        self.choose("b", "none")
        page.evaluate("document.querySelector('#stage').focus()")
        seen = []
        for _ in range(3):
            page.key(" ")
            seen.append(self.seen_at(0.5, 0.8)[2])
        self.assertEqual(seen, ["deep-opacity", "none", "deep-opacity"])

    def test_keys_choose_b_behind_the_slider_and_with_shift_a(self):
        page = self.open()
        page.key("5")
        page.key("6", shift=True)
        self.assertEqual([m for m, _ in self.methods_across()], ["opacity-shadow", "deep-opacity"])

    def test_the_table_chooses(self):
        page = self.open()
        page.click_on("tr [data-pick=none]")
        self.assertEqual(self.seen_at(0.8, 0.8)[2], "none")


class Zoom(Case):
    def test_the_pixel_under_the_cursor_stays(self):
        page = self.open()
        left, top, width, height = self.stage()
        for across, down in ((0.31, 0.67), (0.83, 0.21)):
            x, y = left + across * width, top + down * height
            place = self.seen(x, y)
            for _ in range(6):
                page.wheel(x, y, -200)
                self.assertEqual(self.seen(x, y), place)
            self.assertGreater(page.evaluate("parseFloat(document.querySelector('#zoom').textContent)"), 10_000)
            for _ in range(3):
                page.wheel(x, y, 120)
                self.assertEqual(self.seen(x, y), place)
            page.key("0")
            self.assertEqual(self.seen(x, y), place)

    def test_magnified_pixels_are_squares_of_one_colour(self):
        page = self.open()
        left, top, width, height = self.stage()
        x, y = left + 0.25 * width, top + 0.75 * height
        for _ in range(6):
            page.wheel(x, y, -200)
        colours = page.pixels(round(left + 10), round(y), round(0.4 * width), 1)[0]
        reds = [red for red, _, _ in colours]
        self.assertTrue(all(red % 2 == 0 for red in reds), "no colour between those of two pixels")
        self.assertLessEqual(len(set(reds)), 3)

    def test_dragging_moves_what_is_seen_for_both_pictures(self):
        page = self.open()
        left, top, width, height = self.stage()
        for _ in range(2):
            page.wheel(left + 0.2 * width, top + 0.5 * height, -200)
        start, end = (left + 0.2 * width, top + 0.7 * height), (left + 0.3 * width, top + 0.6 * height)
        place = self.seen(*start)
        page.drag(start, end)
        self.assertEqual(self.seen(*end), place)
        first = self.seen(left + 0.45 * width, end[1])
        second = self.seen(left + 0.55 * width, end[1])
        self.assertEqual((first[2], second[2]), ("truth", "satf"))
        self.assertEqual(first[1], second[1])
        per_pixel = page.evaluate("parseFloat(document.querySelector('#zoom').textContent)") / 100
        self.assertAlmostEqual(second[0] - first[0], 0.1 * width / per_pixel, delta=1)
        page.click_on("#reset")
        self.assertEqual(self.seen_at(0.002, 0.5)[0], 0)

    def test_the_page_scrolls_where_there_is_nothing_to_zoom_out(self):
        page = self.open(height=500)
        left, top, width, height = self.stage()
        before = page.evaluate("scrollY")
        page.mouse("mouseWheel", left + 50, top + 50, deltaX=0, deltaY=150)
        page.evaluate("new Promise(done => setTimeout(done, 300))")
        self.assertGreater(page.evaluate("scrollY"), before)


class Insets(Case):
    def test_a_click_shows_that_place_of_every_method(self):
        page = self.open()
        left, top, width, height = self.stage()
        page.click(left + 0.25 * width, top + 0.6 * height)
        self.assertEqual(page.evaluate("document.querySelectorAll('.crops canvas').length"), len(DRAWN))
        middle = "[...document.querySelectorAll('.crops canvas')].map(c => [...c.getContext('2d').getImageData(" \
                 "c.width / 2, c.height / 2, 1, 1).data])"
        for i, (red, green, blue, alpha) in enumerate(page.evaluate(middle)):
            self.assertAlmostEqual(red, 2 * 0.25 * WIDTH, delta=4)
            self.assertAlmostEqual(green, 2 * 0.6 * HEIGHT, delta=4)
            self.assertEqual((blue, alpha), (20 * i, 255))
        self.assertEqual(page.evaluate("getComputedStyle(document.querySelector('.crops canvas')).imageRendering"), "pixelated")

    def test_there_are_three_at_most_and_each_can_go(self):
        page = self.open()
        for across in (0.1, 0.3, 0.6, 0.9):
            left, top, width, height = self.stage()
            page.click(left + across * width, top + 0.7 * height)
        self.assertEqual(page.evaluate("document.querySelectorAll('.inset').length"), 3)
        first = page.evaluate("document.querySelector('.inset header span').textContent")
        self.assertTrue(first.startswith("28, "), first)  # 0.3 * 120 - 16 / 2: the oldest is gone
        page.click_on(".inset header button")
        self.assertEqual(page.evaluate("document.querySelectorAll('.inset').length"), 2)

    def test_they_follow_the_layer(self):
        page = self.open()
        page.key("i")
        page.click_on("input[value=error] + span")
        self.assertEqual(page.evaluate("document.querySelectorAll('.crops canvas')[1].getContext('2d').getImageData(1, 1, 1, 1).data[2]"), 25)


class Table(Case):
    page_file = "moving.html"

    def order(self):
        return self.page.evaluate("[...document.querySelectorAll('tbody [data-pick]')].map(a => a.dataset.pick)")

    def values(self, column):
        return self.page.evaluate("[...document.querySelectorAll('tbody tr:not(.failed)')].map(r => r.cells[%d].dataset.value)" % column)

    def test_every_column_sorts_both_ways_with_failed_rows_last(self):
        page = self.open()
        heads = page.evaluate("[...document.querySelectorAll('thead th')].map(h => h.textContent)")
        self.assertEqual(len(heads), 12)
        for column in range(1, len(heads)):
            for direction in ("ascending", "descending"):
                page.click_on(f"thead th:nth-child({column + 1})")
                self.assertEqual(page.evaluate(
                    "[...document.querySelectorAll('thead th')].map(h => h.getAttribute('aria-sort'))"),
                    ["none"] * column + [direction] + ["none"] * (len(heads) - column - 1))
                values = self.values(column)
                self.assertEqual(len(values), len(DRAWN))
                numbers = [float(v) for v in values if v]
                self.assertEqual(numbers, sorted(numbers, reverse=direction == "descending"), heads[column])
                self.assertEqual(values[len(numbers):], [""] * (len(values) - len(numbers)), "undefined after numbers")
                self.assertEqual(self.order()[-1], "broken")

    def test_known_orders(self):
        page = self.open()
        page.click_on("thead [data-column=rmse]")
        self.assertEqual(self.order(), ["truth", "density-map-printed", "opacity-shadow", "deep-opacity", "satf", "density-map",
                                        "none", "broken"])
        page.click_on("thead [data-column=first]")  # as text 1024 would come before 2 and 31
        self.assertEqual(self.order(), ["none", "satf", "deep-opacity", "density-map-printed", "density-map", "opacity-shadow",
                                        "truth", "broken"])
        page.click_on("thead [data-column=psnr]")
        page.click_on("thead [data-column=psnr]")
        self.assertEqual(self.order(), ["truth", "density-map-printed", "opacity-shadow", "satf", "density-map", "none",
                                        "deep-opacity", "broken"])

    def test_names_sort_as_text(self):
        page = self.open()
        page.click_on("thead th")
        names = page.evaluate("[...document.querySelectorAll('tbody tr:not(.failed) th')].map(h => h.textContent)")
        self.assertEqual(names[1:], sorted(names[1:]))
        page.click_on("thead th")
        self.assertEqual(self.order()[0], "satf")
        self.assertEqual(self.order()[-1], "broken")

    def test_enter_and_space_sort(self):
        page = self.open()
        page.evaluate("document.querySelector('thead [data-column=rmse] button').focus()")
        page.key("Enter")
        self.assertEqual(self.order()[:2], ["truth", "density-map-printed"])
        page.key(" ")
        self.assertEqual(self.order()[0], "none")

    def test_the_best_of_each_column_is_marked_and_never_the_truth(self):
        page = self.open()
        best = page.evaluate("Object.fromEntries([...document.querySelectorAll('thead th[data-column]')].map((h, i) => ["
                             "h.dataset.column, [...document.querySelectorAll('tbody tr')].filter(r => r.cells[i + 1] &&"
                             " r.cells[i + 1].classList.contains('best')).map(r => r.cells[0].firstChild.dataset.pick)]))")
        errors = dict.fromkeys(["rmse", "rmse-covered", "bias", "rel-mse", "psnr", "flip", "flicker"], ["density-map-printed"])
        costs = dict.fromkeys(["first", "again", "memory"], ["none"])
        self.assertEqual(best, {**errors, "prepare": [], **costs})

    def test_figures_below_the_noise_of_the_truth_are_marked(self):
        page = self.open()
        marked = page.evaluate("[...document.querySelectorAll('tbody tr')].filter(r => r.cells[1].querySelector('.approx'))"
                               ".map(r => r.cells[0].firstChild.dataset.pick)")
        self.assertEqual(marked, ["density-map-printed", "opacity-shadow"])


class Commands(Case):
    def test_a_click_copies(self):
        page = self.open()
        browser.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        page.evaluate("window.copied = ''; navigator.clipboard.writeText = async text => { window.copied = text; }")
        page.click_on(".command:nth-of-type(3) button")
        self.assertEqual(page.evaluate("copied"), "pelage render 'hair <1>.json' --method satf")
        self.assertEqual(page.evaluate("document.querySelector('.command:nth-of-type(3) button').textContent"), "Copied")


class RealPage(unittest.TestCase):
    """What holds for any comparison: --page."""

    file = None

    def test_it_loads_slides_and_sorts(self):
        page = Page(browser)
        self.addCleanup(page.close)
        page.open(self.file)
        self.assertEqual(page.complaints(), [])
        left, top, width, height = page.box("#stage")
        before = page.pixels(round(left), round(top), round(width), round(height), scale=0.25)
        page.drag((left + width / 2, top + height / 3), (left + 0.1 * width, top + height / 3))
        after = page.pixels(round(left), round(top), round(width), round(height), scale=0.25)
        self.assertNotEqual(before, after)
        page.click_on("thead [data-column=rmse]")
        values = page.evaluate("[...document.querySelectorAll('tbody tr:not(.failed)')].map(r => r.cells[1].dataset.value)")
        numbers = [float(v) for v in values if v]
        self.assertGreater(len(numbers), 2)
        self.assertEqual(numbers, sorted(numbers))


def main():
    global folder, browser
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=Path, help="the program comparison_sample")
    parser.add_argument("--folder", type=Path, help="where its pages and the screenshots go")
    parser.add_argument("--page", type=Path, help="index.html of a real comparison, instead")
    parser.add_argument("tests", nargs="*", help="only these, as in Slider or Slider.test_it_stops_at_the_edges")
    options = parser.parse_args()
    program = find_browser()
    if not program:
        print("no Chromium here (chromium-headless-shell): " + ("needed in CI" if os.environ.get("CI") == "true" else "skipped"))
        return 1 if os.environ.get("CI") == "true" else 77
    if options.page:
        RealPage.file = options.page
        names = ["RealPage"]
    else:
        folder = options.folder
        subprocess.run([options.sample, folder], check=True)
        names = options.tests or ["Loading", "WithoutScript", "Slider", "Choosing", "Zoom", "Insets", "Table", "Commands"]
    with Browser(program) as browser:
        suite = unittest.defaultTestLoader.loadTestsFromNames(names, sys.modules[__name__])
        return 0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
