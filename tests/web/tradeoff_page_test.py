#!/usr/bin/env python3
"""The page of `pelage tradeoff` in headless Chromium: what a person would do with it, by mouse and keys.

The page comes from tradeoff_sample, which writes the same as tradeoff.json: what the page must show is read from there.
Exit code 77: no browser here (with CI=true: 1).
"""

import argparse
import json
import math
import os
import subprocess
import sys
import unittest
from pathlib import Path

from browser import Browser, Page, decode_png, find_browser

HOSTILE = "</script><img src=x onerror=\"document.title='ran'\"> & 'hair' {{scene}} \ufffd"
AXES = {"ms": lambda r: r["time"]["median_ms"], "bytes": lambda r: r["bytes"], "prepare": lambda r: r["prepare_ms"]}
folder = None
browser = None
diagrams = {}


def positive(value):
    return isinstance(value, (int, float)) and value > 0 and math.isfinite(value)


def measured(diagram):
    return [r for r in diagrams[diagram]["rows"] if not r["failed"]]


def on_axes(diagram, axis="ms"):
    return [r for r in measured(diagram) if positive(r["error"]) and positive(AXES[axis](r))]


def front_of(diagram, axis):
    """Rows that no row beats on that axis, from their figures alone."""
    rows, value = on_axes(diagram, axis), AXES[axis]
    return [r for r in rows if not any(value(q) <= value(r) and q["error"] <= r["error"] and
                                       (value(q) < value(r) or q["error"] < r["error"]) for q in rows)]


def names(diagram, rows):
    return sorted(f"{diagram}/{r['id']}" for r in rows)


class Case(unittest.TestCase):
    def open(self, **how):
        self.page = Page(browser, **how)
        self.addCleanup(self.page.close)
        self.page.open(folder / "index.html")
        return self.page

    def all(self, selector, value):
        """value, in JavaScript with the element as e, of every element."""
        return self.page.evaluate(f"[...document.querySelectorAll({json.dumps(selector)})].map(e => {value})")

    def one(self, selector, value):
        return self.page.evaluate(f"(e => {value})(document.querySelector({json.dumps(selector)}))")

    def place(self, diagram, row, axis="ms"):
        """Middle of a point in the window, scrolled to be seen."""
        selector = f'#{diagram} .axis[data-axis={axis}] [class~=point][data-row="{diagram}/{row}"] .reach'
        left, top, width, height = self.page.box(selector)
        return left + width / 2, top + height / 2

    def pick(self, diagram, row, axis="ms"):
        self.page.click(*self.place(diagram, row, axis))

    def panel(self, diagram="transmittance"):
        return self.one(f"#{diagram} .panel", "e.hidden ? null : e.innerText")

    def focused(self):
        return self.page.evaluate("document.activeElement.dataset.row || document.activeElement.className")


class Loading(Case):
    def test_nothing_is_written_to_the_console_and_nothing_is_fetched(self):
        self.assertEqual(self.open().complaints(), [])

    def test_texts_that_are_html_are_shown_as_text_and_run_nothing(self):
        page = self.open()
        self.pick("transmittance", "harm")
        self.assertIn(HOSTILE, page.evaluate("document.title"))
        self.assertEqual(self.one("h1", "e.textContent"), HOSTILE)
        self.assertIn(HOSTILE, self.all(".knobs span", "e.textContent"))
        self.assertEqual(self.one("#transmittance .panel .command code", "e.textContent"), HOSTILE)
        self.assertIn(HOSTILE, self.panel())
        self.assertEqual(self.one("#extremes .truth", "e.textContent"), "Truth: " + HOSTILE)
        self.assertIn(f"harm-failed", " ".join(self.all(".failures a", "e.dataset.row")))
        self.assertIn("</script><b>hair", self.one("#provenance code", "e.textContent"))
        self.assertEqual(page.evaluate("document.querySelectorAll('img[onerror], img[src=x], main b b').length"), 0)
        self.assertEqual(page.evaluate("document.querySelectorAll('script').length"), 1)
        self.assertEqual(page.complaints(), [])

    def test_it_is_no_blank_sheet_in_light_and_dark_wide_and_narrow(self):
        for width in (1280, 700):
            for dark in (False, True):
                page = self.open(width=width, dark=dark)
                name = f"screenshot-{width}-{'dark' if dark else 'light'}.png"
                page.screenshot(folder / name, whole=True)
                self.pick("transmittance", "density-map.cells-64")
                self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth"), width, "nothing sticks out")
                left, top, w, h = page.box("#transmittance .axis svg")
                colours = {p for row in page.pixels(left, top, w, min(h, 700)) for p in row}
                self.assertGreater(len(colours), 300, name)
                self.assertEqual(sum(page.pixel(2, 450)) < 384, dark, "the paper's colour")

    def test_there_is_no_figure_that_is_none(self):
        self.open()
        drawn = " ".join(self.all("svg *", "[...e.attributes].map(a => a.name.match(/^(d|x|y|transform)$/) ? a.value : '').join(' ')"))
        self.assertNotRegex(drawn, r"(?i)nan|inf")

    def test_an_address_opens_its_point(self):
        self.open()
        self.page.call("Page.navigate", url="about:blank")
        browser.wait_for(self.page.session, "Page.loadEventFired")
        self.page.call("Page.navigate", url=(folder / "index.html").resolve().as_uri() + "#transmittance/density-map.cells-8")
        browser.wait_for(self.page.session, "Page.loadEventFired")
        self.page.settle()
        self.assertIn("density-map.cells = 8", self.panel())


class Charts(Case):
    def test_every_row_is_on_each_chart_or_in_the_list_beneath_or_failed(self):
        self.open()
        for d in diagrams:
            if not diagrams[d]["rows"]:
                self.assertEqual(self.all(f"#{d} svg", "1"), [])
                continue
            for axis in AXES:
                chart = f"#{d} .axis[data-axis={axis}]"
                drawn = on_axes(d, axis)
                self.assertEqual(sorted(self.all(f"{chart} .point", "e.dataset.row")), names(d, drawn), chart)
                self.assertEqual(sorted(self.all(f"{chart} .elsewhere a", "e.dataset.row")),
                                 names(d, [r for r in measured(d) if r not in drawn]), chart)
            self.assertEqual(sorted(self.all(f"#{d} .card", "e.id")), names(d, diagrams[d]["rows"]))

    def test_reasons_of_failed_rows_are_listed(self):
        self.open()
        items = self.all("#transmittance .failures li", "e.textContent")
        failed = [r for r in diagrams["transmittance"]["rows"] if r["failed"]]
        self.assertEqual(len(failed), 2)
        self.assertEqual([i.split(": ", 1)[1] for i in items], [r["failed"] for r in failed])

    def test_points_lie_where_their_figures_say(self):
        """Pixels are straight in the logarithms, against marks of the axes that are themselves read from the page."""
        self.open()
        for d, axis in (("transmittance", "ms"), ("transmittance", "bytes"), ("picture", "prepare"), ("extremes", "ms")):
            found = {row: place for row, place in self.all(
                f"#{d} .axis[data-axis={axis}] .point", "[e.dataset.row, [e.transform.baseVal[0].matrix.e, e.transform.baseVal[0].matrix.f]]")}
            rows = on_axes(d, axis)
            for k, value in ((0, AXES[axis]), (1, lambda r: r["error"])):
                ordered = sorted(rows, key=value)
                low, high = ordered[0], ordered[-1]
                x0, x1 = (found[f"{d}/{r['id']}"][k] for r in (low, high))
                self.assertTrue(x1 > x0 if k == 0 else x1 < x0, "time goes right, error goes up")
                for r in rows:
                    share = math.log(value(r) / value(low)) / math.log(value(high) / value(low))
                    self.assertAlmostEqual(found[f"{d}/{r['id']}"][k], x0 + share * (x1 - x0), delta=0.2)

    def test_axes_are_labelled_where_the_points_say(self):
        self.open()
        ticks = self.all("#transmittance .axis[data-axis=ms] svg > text.mid:not(.title)", "[e.textContent, e.x.baseVal[0].value]")
        points = dict(self.all("#transmittance .axis[data-axis=ms] .point", "[e.dataset.row, e.transform.baseVal[0].matrix.e]"))
        rows = on_axes("transmittance")
        a, b = rows[0], rows[7]
        xa, xb = (points["transmittance/" + r["id"]] for r in (a, b))
        ya, yb = (math.log(AXES["ms"](r)) for r in (a, b))
        self.assertGreaterEqual(len(ticks), 3)
        for label, x in ticks:
            self.assertAlmostEqual(math.log(float(label)), ya + (x - xa) * (yb - ya) / (xb - xa), delta=0.01)
        exponents = self.all("#extremes .axis[data-axis=ms] svg > text.end .exponent", "e.textContent")
        self.assertIn("\u221210", exponents)

    def test_labels_do_not_cover_each_other(self):
        self.open()
        for d in ("transmittance", "picture", "extremes", "single"):
            boxes = self.all(f"#{d} .axis[data-axis=ms] svg text", "(b => [b.left, b.top, b.right, b.bottom, e.textContent])(e.getBoundingClientRect())")
            self.assertGreater(len(boxes), 5)
            for i, p in enumerate(boxes):
                for q in boxes[:i]:
                    apart = p[0] >= q[2] or q[0] >= p[2] or p[1] >= q[3] or q[1] >= p[3]
                    self.assertTrue(apart, (d, p, q))
            marks = self.all(f"#{d} .axis[data-axis=ms] .point .mark", "(b => [b.left, b.top, b.right, b.bottom])(e.getBoundingClientRect())")
            named = self.all(f"#{d} .axis[data-axis=ms] .name", "(b => [b.left, b.top, b.right, b.bottom, e.textContent])(e.getBoundingClientRect())")
            for p in named:
                for q in marks:
                    across, down = min(p[2], q[2]) - max(p[0], q[0]), min(p[3], q[3]) - max(p[1], q[1])
                    self.assertFalse(across > 2 and down > 2, (d, p, q))

    def test_the_front_is_that_of_the_rows(self):
        self.open()
        for d in ("transmittance", "picture", "single"):
            marked = [r for r in measured(d) if r["on_front"]]
            self.assertEqual(names(d, marked), names(d, front_of(d, "ms")), "the sample's own")
            for axis in AXES:
                front = marked if axis == "ms" else front_of(d, axis)
                chart = f"#{d} .axis[data-axis={axis}]"
                self.assertEqual(sorted(self.all(f"{chart} .point.on-front", "e.dataset.row")), names(d, front), chart)
                self.assertEqual(len(self.all(f"{chart} .point.under", "1")), len(on_axes(d, axis)) - len(front))
                self.assertEqual(len(self.all(f"{chart} svg > .front", "1")), 1 if front else 0)

    def test_the_line_of_the_front_goes_through_its_points_and_never_up(self):
        self.open()
        path = self.one("#transmittance .axis[data-axis=ms] .front", "e.getAttribute('d')")
        corners = [tuple(map(float, part.split("V"))) for part in path.split("H")[1:-1]]
        places = self.all("#transmittance .axis[data-axis=ms] .on-front", "[e.transform.baseVal[0].matrix.e, e.transform.baseVal[0].matrix.f]")
        self.assertEqual(corners, [(round(x, 1), round(y, 1)) for x, y in sorted(places)])
        self.assertEqual([y for _, y in corners], sorted(y for _, y in corners))

    def test_curves_join_a_knobs_points_in_order_of_amount_and_choices_are_not_joined(self):
        self.open()
        knobs = self.all("#transmittance .knobs li", "[e.dataset.knob, e.textContent]")
        places = dict(self.all("#transmittance .axis[data-axis=ms] .point", "[e.dataset.row, e.getAttribute('transform').slice(10, -1)]"))
        paths = dict(self.all("#transmittance .axis[data-axis=ms] .curve", "[e.dataset.knob, e.getAttribute('d').slice(1)]"))
        self.assertEqual(len(paths), 5)
        for number, knob in knobs:
            rows = [r for r in on_axes("transmittance") if r["knob"] == knob and r["amount"] is not None]
            expected = [places["transmittance/" + r["id"]] for r in sorted(rows, key=lambda r: r["amount"])]
            self.assertEqual(paths[number].split("L") if number in paths else [], expected, knob)

    def test_twenty_knobs_look_different(self):
        self.open()
        looks = self.all("#picture .knobs li", "e.className + e.querySelector('.mark').getAttribute('d')")
        self.assertEqual(len(looks), 21)
        self.assertEqual(len(set(looks)), 21)

    def test_defaults_and_papers_have_marks_and_names_of_their_own(self):
        self.open()
        star = self.one("#transmittance .axis[data-axis=ms] .point.default .mark", "e.getAttribute('d')")
        self.assertEqual(self.all("#transmittance .axis[data-axis=ms] .point .mark", "e.getAttribute('d')").count(star), 1)
        ringed = self.all("#transmittance .axis[data-axis=ms] .point:has(.ring)", "e.dataset.row")
        self.assertEqual(sorted(ringed), names("transmittance", [r for r in measured("transmittance") if r["paper"]]))
        self.assertEqual(sorted(self.all("#transmittance .axis[data-axis=ms] .name", "e.textContent")),
                         ["Bertails2005", "Mertens2004", "Sintorn2008", "Yuksel2008", "default"])

    def test_bars_reach_as_far_as_error_and_time_do_and_stay_on_the_chart(self):
        self.open()
        frame = self.one("#extremes .axis[data-axis=ms] .behind, #extremes .axis[data-axis=ms] .frame", "e.getAttribute('d')")
        bars = dict(self.all("#extremes .axis[data-axis=ms] .bars", "[e.dataset.of, (b => [b.x, b.y, b.x + b.width, b.y + b.height])(e.getBBox())]"))
        left, top, right, bottom = 74, 12, 766, 448
        self.assertTrue(frame.startswith(f"M{left} {top}V{bottom}"), frame)
        for row, box in bars.items():
            self.assertGreaterEqual(round(box[0], 1), left - 2.5, row)
            self.assertLessEqual(round(box[2], 1), right + 2.5, row)
            self.assertGreaterEqual(round(box[1], 1), top - 2.5, row)
            self.assertLessEqual(round(box[3], 1), bottom + 2.5, row)
        rows = {r["id"]: r for r in measured("extremes")}
        tall = [r for r in rows if rows[r]["error_bar"] == 1e9]
        wide = [r for r in rows if rows[r]["time"]["max_ms"] == "inf" and positive(AXES["ms"](rows[r]))]
        self.assertEqual((len(tall), len(wide)), (1, 1))
        self.assertAlmostEqual(bars["extremes/" + tall[0]][3] - bars["extremes/" + tall[0]][1], bottom - top, delta=0.5)
        self.assertAlmostEqual(bars["extremes/" + wide[0]][2], right, delta=0.5)

    def test_it_says_where_better_is(self):
        self.open()
        for d in ("transmittance", "single"):
            self.assertEqual(self.one(f"#{d} .axis[data-axis=ms] .better text", "e.textContent"), "better")
            self.assertIn("down and left is better", self.one(f"#{d} .axis svg", "e.getAttribute('aria-label')"))


class Points(Case):
    def test_a_click_shows_its_picture_settings_command_and_figures(self):
        page = self.open()
        for row in ("density-map.cells-64", "opacity-shadow.maps-32"):
            self.pick("transmittance", row)
            r = next(r for r in measured("transmittance") if r["id"] == row)
            panel = self.panel()
            self.assertIn(f"{r['knob']} = {r['label']}", panel)
            for setting in r["settings"]:
                self.assertIn(setting, panel)
            self.assertEqual(self.one("#transmittance .panel .command code", "e.textContent"), r["command"])
            self.assertIn(f"{r['time']['median_ms']:.3g}", panel)
            self.assertIn(f"{r['others'][0]['value']:.3g}".replace("-", "\u2212"), panel)
            if r["on_front"]:
                self.assertIn("on the front", panel)
            else:
                better = next(q for q in measured("transmittance") if q["id"] == r["dominated_by"])
                self.assertIn("dominated by", panel)
                self.assertEqual(self.all("#transmittance .panel dd a", "e.dataset.row"), ["transmittance/" + better["id"]])
            self.assertEqual(set(self.all("#transmittance .axis[data-axis=ms] .chosen", "e.dataset.row")), {"transmittance/" + row})
        self.assertEqual(page.complaints(), [])

    def test_its_picture_stands_beside_that_of_the_defaults_and_of_the_least_error(self):
        page = self.open()
        rows = diagrams["transmittance"]["rows"]
        usual = next(r for r in rows if r["knob"] == "default")
        best = min((r for r in measured("transmittance") if r["picture"] and r["error"] is not None), key=lambda r: r["error"])
        self.assertTrue(usual["picture"] and best["picture"] and best is not usual)
        for row, expected in ((rows[3], [rows[3], usual, best]), (usual, [usual, best]), (best, [best, usual]), (rows[5], [])):
            self.pick("transmittance", row["id"])
            page.evaluate("Promise.all([...document.images].map(i => i.decode()))")
            colours = []
            for i in range(len(self.all("#transmittance .panel img", "1"))):
                left, top, width, height = page.box(f"#transmittance .panel figure:nth-of-type({i + 1}) img")
                colours.append(page.pixel(round(left + width / 2), round(top + height / 2)))
            self.assertEqual(colours, [(8 * (rows.index(r) % 32), 200, 60) for r in expected], row["id"])
        self.assertEqual(rows[5]["picture"], "")

    def test_what_dominates_it_is_a_click_away(self):
        page = self.open()
        row = next(r for r in measured("transmittance") if not r["on_front"] and r["knob"] == "opacity-shadow.maps")
        self.pick("transmittance", row["id"])
        page.click_on("#transmittance .panel dd a")
        better = next(q for q in measured("transmittance") if q["id"] == row["dominated_by"])
        self.assertIn(f"{better['knob']} = {better['label']}" if better["knob"] != "default" else "default", self.panel().split("\n")[1])

    def test_the_pointer_is_told_the_point(self):
        page = self.open()
        page.mouse("mouseMoved", *self.place("transmittance", "density-map.cells-128"))
        page.settle()
        tip = self.one("#tip", "e.hidden ? null : e.innerText")
        self.assertIn("density-map.cells = 128", tip)
        self.assertIn("dominated by", tip)
        page.mouse("mouseMoved", 3, 3)
        page.settle()
        self.assertTrue(self.one("#tip", "e.hidden"))

    def test_every_point_can_be_picked(self):
        """By the mouse where it is nearest; where others cover it, the panel of those leads on to it."""
        self.open()
        for r in on_axes("transmittance")[::3]:
            self.pick("transmittance", r["id"])
            reached = self.one("#transmittance .panel", "[e.dataset.of, ...[...e.querySelectorAll('.note a')].map(a => a.dataset.row)]")
            self.assertIn("transmittance/" + r["id"], reached)

    def test_keys_walk_along_the_points_enter_opens_and_escape_returns(self):
        page = self.open()
        order = [f"transmittance/{r['id']}" for r in sorted(on_axes("transmittance"), key=AXES["ms"])]
        self.assertEqual(len(self.all("#transmittance .axis[data-axis=ms] .point[tabindex='0']", "1")), 1)
        self.one("#transmittance input:checked", "e.focus()")
        page.key("Tab")
        self.assertEqual(self.focused(), order[0])
        self.assertFalse(self.one("#tip", "e.hidden"))
        page.key("ArrowRight")
        page.key("ArrowRight")
        self.assertEqual(self.focused(), order[2])
        page.key("ArrowLeft")
        self.assertEqual(self.focused(), order[1])
        page.key("End")
        self.assertEqual(self.focused(), order[-1])
        page.key("Home")
        page.key("ArrowDown")
        knob = [n for n in order if n.split("/")[1].rsplit("-", 1)[0] == order[0].split("/")[1].rsplit("-", 1)[0]]
        self.assertEqual(self.focused(), knob[1])
        page.key("Enter")
        self.assertIn(knob[1].split("-")[-1], self.panel().split("\n")[1])
        self.assertEqual(self.focused(), "panel")
        page.key("Escape")
        self.assertIsNone(self.panel())
        self.assertEqual(self.focused(), knob[1])

    def test_the_command_is_copied(self):
        page = self.open()
        page.evaluate("window.copied = ''; navigator.clipboard.writeText = async text => { window.copied = text; }")
        self.pick("transmittance", "density-map.cells-64")
        page.click_on("#transmittance .panel .command button")
        self.assertEqual(page.evaluate("copied"), "pelage render 'hair <1>.json' --set density-map.cells=64")
        self.assertEqual(self.all("#transmittance .panel .command button", "e.textContent"), ["Copied"])

    def test_a_listed_point_opens_too(self):
        page = self.open()
        page.click_on("#extremes .axis[data-axis=ms] .elsewhere a")
        self.assertIn("odd = no-error", self.panel("extremes"))
        page.click_on("#transmittance .failures a")
        self.assertIn("not enough memory: 256 GiB <needed> & 'asked for'", self.panel())

    def test_a_row_from_elsewhere_says_so(self):
        self.open()
        self.pick("extremes", diagrams["extremes"]["rows"][1]["id"])
        self.assertIn("older00", self.panel("extremes"))
        self.pick("extremes", diagrams["extremes"]["rows"][0]["id"])
        self.assertNotIn("Measured", self.panel("extremes"))


class Axis(Case):
    def shown(self):
        return self.page.evaluate("[...document.querySelectorAll('#transmittance .axis')].filter(e => e.checkVisibility()).map(e => e.dataset.axis)")

    def test_it_is_switched_by_mouse_and_keys_with_a_script_and_without(self):
        for script in (True, False):
            page = self.open(script=script)
            self.assertEqual(self.shown(), ["ms"])
            page.click_on("#transmittance input[value=bytes] + span")
            self.assertEqual(self.shown(), ["bytes"])
            page.key("ArrowRight")
            self.assertEqual(self.shown(), ["prepare"])
            self.assertEqual(self.one("#picture .axis[data-axis=ms]", "e.checkVisibility()"), True, "others keep theirs")

    def test_points_of_another_axis_open_too(self):
        page = self.open()
        page.click_on("#transmittance input[value=bytes] + span")
        self.pick("transmittance", "deep-opacity.layers-128", "bytes")
        self.assertIn("deep-opacity.layers = 128", self.panel())


class Legend(Case):
    def visible(self, knob):
        number = dict((text, n) for n, text in self.all("#picture .knobs li", "[e.dataset.knob, e.textContent]"))[knob]
        return self.page.evaluate(f"[...document.querySelectorAll('#picture .axis[data-axis=ms] svg [data-knob=\"{number}\"]')].filter(e => e.checkVisibility()).length")

    def test_a_click_hides_a_knobs_curve_bars_and_points_and_another_shows_them(self):
        page = self.open()
        before, others = self.visible("knob-03.setting"), self.visible("knob-04.setting")
        self.assertEqual(before, 3 + 3 + 1)
        button = "#picture .knobs li:nth-child(4) button"
        page.click_on(button)
        self.assertEqual((self.visible("knob-03.setting"), self.visible("knob-04.setting")), (0, others))
        self.assertEqual(self.one(button, "e.getAttribute('aria-pressed')"), "false")
        self.assertEqual(self.one("#transmittance .axis[data-axis=ms] [data-knob='3']", "e.checkVisibility()"), True, "of this diagram")
        page.click_on("#picture input[value=bytes] + span")
        self.assertEqual(self.all("#picture .axis[data-axis=bytes] .point[data-knob='3']", "e.checkVisibility()"), [False] * 3)
        page.click_on("#picture input[value=ms] + span")
        self.one(button, "e.focus()")
        page.key("Enter")
        self.assertEqual(self.visible("knob-03.setting"), before)

    def test_one_of_twenty_can_be_left_alone(self):
        page = self.open()
        page.click_on("#picture .all-none button:nth-child(2)")
        page.click_on("#picture .knobs li:nth-child(8) button")
        seen = [n for n in range(21) if self.visible(self.all("#picture .knobs li", "e.textContent")[n])]
        self.assertEqual(seen, [7])
        self.one("#picture .axis[data-axis=ms] .point[tabindex='0']:not(.off)", "e.focus()")
        page.key("Home")
        page.key("ArrowRight")
        rows = sorted((r for r in on_axes("picture") if r["knob"] == "knob-07.setting"), key=AXES["ms"])
        self.assertEqual(self.focused(), "picture/" + rows[1]["id"], "arrows pass over what is hidden")
        page.click_on("#picture .all-none button:nth-child(1)")
        self.assertEqual(len([n for n in range(21) if self.visible(self.all("#picture .knobs li", "e.textContent")[n])]), 21)


class WithoutScript(Case):
    def test_charts_tables_figures_pictures_and_commands_are_there(self):
        page = self.open(script=False)
        seen = lambda selector: page.evaluate(f"[...document.querySelectorAll({json.dumps(selector)})].filter(e => e.checkVisibility()).length")
        for d in diagrams:
            rows = diagrams[d]["rows"]
            if not rows:
                continue
            self.assertEqual(seen(f"#{d} .axis .point"), len(on_axes(d)))
            self.assertEqual(seen(f"#{d} .card"), len(rows))
            self.assertEqual(self.all(f"#{d} .card code:not(dd code)", "e.textContent"), [r["command"] for r in rows])
        self.assertEqual(page.evaluate("[...document.querySelectorAll('#transmittance img')].filter(i => i.naturalWidth === 96 && i.checkVisibility()).length"),
                         len([r for r in measured("transmittance") if r["picture"]]))
        self.assertIn("density-map.cells = 64", self.one("#transmittance .point[data-row$='cells-64'] title", "e.textContent"))
        self.assertEqual(page.complaints(), [])

    def test_a_click_on_a_point_leads_to_its_entry(self):
        page = self.open(script=False)
        self.pick("transmittance", "opacity-shadow.maps-128")
        self.assertEqual(page.evaluate("document.querySelector(':target h4').textContent"), "opacity-shadow.maps = 128")

    def test_front_tables_are_in_order_of_time(self):
        self.open(script=False)
        for d in ("transmittance", "picture", "extremes", "single"):
            front = sorted((r for r in measured(d) if r["on_front"]), key=AXES["ms"])
            self.assertGreater(len(front), 0)
            self.assertEqual(self.all(f"#{d} .of-front tbody tr", "e.dataset.row"), [f"{d}/{r['id']}" for r in front])
        first = self.all("#transmittance .of-front tbody tr:first-child > *", "e.textContent")
        self.assertEqual(first[1], f"{front_of('transmittance', 'ms')[0]['time']['median_ms']:.3g}")

    def test_slopes_with_their_errors_and_the_words_about_the_run(self):
        self.open(script=False)
        slopes = diagrams["transmittance"]["slopes"]
        table = self.all("#transmittance .slopes tbody tr", "[...e.cells].map(c => c.textContent)")
        self.assertGreater(len(slopes), 4)
        self.assertEqual([[t[0], t[1], t[3]] for t in table], [[s["knob"], s["against"], str(s["points"])] for s in slopes])
        for shown, s in zip(table, slopes):
            self.assertEqual(shown[2].replace("\u2212", "-"), f"{s['slope']:+.2f} \u00b1 {s['standard_error']:.2f}")
        self.assertIn("4096 rays a vertex", self.one("#transmittance .truth", "e.textContent"))
        words = self.one("#provenance dl", "e.innerText")
        for said in ("0123456789abcdef", "abc1234", "A processor, 3 GHz", "\n2\n", "\n7"):
            self.assertIn(said, words)
        self.assertIn("A quick run", self.one(".summary", "e.textContent"))


def main():
    global folder, browser, diagrams
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=Path, required=True, help="the program tradeoff_sample")
    parser.add_argument("--folder", type=Path, required=True, help="where its page and the screenshots go")
    parser.add_argument("tests", nargs="*", help="only these, as in Points or Axis.test_points_of_another_axis_open_too")
    options = parser.parse_args()
    program = find_browser()
    if not program:
        print("no Chromium here (chromium-headless-shell): " + ("needed in CI" if os.environ.get("CI") == "true" else "skipped"))
        return 1 if os.environ.get("CI") == "true" else 77
    folder = options.folder
    subprocess.run([options.sample, folder], check=True)
    diagrams = {d["id"]: d for d in json.loads((folder / "tradeoff.json").read_text())["diagrams"]}
    tests = options.tests or ["Loading", "Charts", "Points", "Axis", "Legend", "WithoutScript"]
    with Browser(program) as browser:
        suite = unittest.defaultTestLoader.loadTestsFromNames(tests, sys.modules[__name__])
        return 0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
