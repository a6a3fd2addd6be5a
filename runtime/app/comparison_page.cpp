#include "pelage/app/comparison_page.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

#include "pages_web.h"
#include "pelage/app/page_charts.h"
#include "pelage/app/page_text.h"
#include "pelage/data_schema/errors.h"
#include "pelage/image/draw.h"

namespace pelage::app {
namespace {

enum class Best { none, least, most, nearest_zero };

struct Column {
  const char* id;
  const char* head;
  const char* what;
  int decimals;  // below 0: milliseconds
  Best best;
  bool error;     // against the truth: the truth itself has none
  bool animated;  // of animated comparisons only
  double (*value)(const ComparedMethod&);
  double (*noise)(const Comparison&) = nullptr;  // of the truth, in this column
};

constexpr Column kColumns[] = {
    {"rmse", "RMSE", "root mean square of the difference of linear RGB", 4, Best::least, true, false,
     [](const ComparedMethod& m) { return m.error.rmse; }, [](const Comparison& c) { return c.truth_noise.rmse; }},
    {"rmse-covered", "RMSE on hair", "the same over the pixels that hair and head cover at least by half", 4,
     Best::least, true, false, [](const ComparedMethod& m) { return m.error.rmse_covered; },
     [](const Comparison& c) { return c.truth_noise.rmse_covered; }},
    {"bias", "bias", "mean of picture \u2212 truth, linear RGB: below 0 is too dark", 4, Best::nearest_zero, true,
     false, [](const ComparedMethod& m) { return m.error.bias; },
     [](const Comparison& c) { return c.truth_noise.bias; }},
    {"rel-mse", "relMSE", "mean of (picture \u2212 truth)\u00B2 / (truth\u00B2 + 0.01), linear RGB", 4, Best::least,
     true, false, [](const ComparedMethod& m) { return m.error.rel_mse; }},
    {"psnr", "PSNR dB", "10 log\u2081\u2080 (1 / MSE) of sRGB values in [0, 1]", 1, Best::most, true, false,
     [](const ComparedMethod& m) { return m.error.psnr_db; }},
    {"flip", "FLIP",
     "mean LDR-FLIP (Andersson et al. 2020) at 67 pixels per degree, from 0, no visible difference, to 1", 4,
     Best::least, true, false, [](const ComparedMethod& m) { return m.error.flip; },
     [](const Comparison& c) { return c.truth_noise.flip; }},
    {"flicker", "flicker", "RMSE of what changes from frame to frame, against what changes in the truth", 4,
     Best::least, true, true, [](const ComparedMethod& m) { return m.flicker; },
     [](const Comparison& c) { return c.flicker_noise; }},
    {"prepare", "prepare ms", "to read, fit, bake or open what the method needs, once for a hair", -1, Best::none,
     false, false, [](const ComparedMethod& m) { return m.prepare_ms; }},
    {"first", "first ms", "of the first picture, everything built", -1, Best::least, false, false,
     [](const ComparedMethod& m) { return m.first_ms; }},
    {"again", "again ms", "of a picture from a camera that has moved a little: what need not change is kept", -1,
     Best::least, false, false, [](const ComparedMethod& m) { return m.again_ms; }},
    {"memory", "MiB", "most that the stages of one frame read, write and upload", 1, Best::least, false, false,
     [](const ComparedMethod& m) { return static_cast<double>(m.bytes) / (1024.0 * 1024.0); }}};

std::vector<Column> columns_of(const Comparison& comparison) {
  std::vector<Column> columns;
  for (const Column& c : kColumns) {
    if (!c.animated || comparison.fps > 0) columns.push_back(c);
  }
  return columns;
}

bool is_truth(const Comparison& comparison, const ComparedMethod& method) {
  return &method == &comparison.methods.front();
}

std::string text_of(const Column& column, double value) {
  return column.decimals < 0 ? milliseconds(value) : number(value, column.decimals, column.best == Best::nearest_zero);
}

// The text of a column's best value; rows that read the same are all the best.
std::string best_text(const Comparison& comparison, const Column& column) {
  std::optional<double> best, best_rank;
  for (const ComparedMethod& m : comparison.methods) {
    const double value = column.value(m);
    if (!m.failed.empty() || is_truth(comparison, m) || std::isnan(value)) continue;
    const double rank = column.best == Best::most           ? -value
                        : column.best == Best::nearest_zero ? std::abs(value)
                                                            : value;
    if (!best_rank || rank < *best_rank) best = value, best_rank = rank;
  }
  return best && column.best != Best::none ? text_of(column, *best) : "";
}

// What the script sorts by: a number that JavaScript reads, or nothing.
std::string sort_value(double value) {
  if (std::isnan(value)) return "";
  return std::isinf(value) ? (value > 0 ? "Infinity" : "-Infinity") : fmt::format("{:.17g}", value);
}

std::string cell(const Comparison& comparison, const Column& column, const ComparedMethod& method,
                 const std::string& best) {
  const double value = column.value(method);
  if (column.error && is_truth(comparison, method)) {
    return fmt::format(R"(<td data-value="{}" class="none">&mdash;</td>)",
                       column.best == Best::most ? "Infinity" : "0");
  }
  const std::string text = text_of(column, value);
  const bool is_best = text == best && !is_truth(comparison, method);
  const bool is_noise = column.noise != nullptr && std::abs(value) <= column.noise(comparison);
  return fmt::format(R"(<td data-value="{}"{}>{}{}{}</td>)", sort_value(value),
                     is_best    ? R"( class="best")"
                     : is_noise ? R"( class="noise")"
                                : "",
                     text, is_best ? R"(<span class="unseen"> best</span>)" : "",
                     is_noise ? R"(<span class="approx" title="not above the truth's own noise">~</span>)" : "");
}

std::string row(const Comparison& comparison, const std::vector<Column>& columns, const ComparedMethod& method,
                const std::vector<std::string>& best) {
  std::string cells = fmt::format(R"(<th scope="row"><a href="#picture-{0}" data-pick="{0}">{1}</a></th>)",
                                  html(method.id), html(method.title));
  if (!method.failed.empty()) {
    return fmt::format("<tr class=\"failed\">{}<td colspan=\"{}\">no picture: {}</td></tr>\n", cells, columns.size(),
                       html(method.failed));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) cells += cell(comparison, columns[i], method, best[i]);
  return fmt::format("<tr{}>{}</tr>\n", is_truth(comparison, method) ? R"( class="truth")" : "", cells);
}

std::string table(const Comparison& comparison) {
  const std::vector<Column> columns = columns_of(comparison);
  std::string head = R"(<th scope="col" data-sort="text">Method</th>)", rows;
  std::vector<std::string> best;
  for (const Column& c : columns) {
    head += fmt::format(R"(<th scope="col" data-sort="number" data-column="{}" title="{}">{}</th>)", c.id, html(c.what),
                        html(c.head));
    best.push_back(best_text(comparison, c));
  }
  for (const ComparedMethod& m : comparison.methods) rows += row(comparison, columns, m, best);
  return fmt::format("<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>", head, rows);
}

std::string definitions(const Comparison& comparison) {
  std::string list;
  for (const Column& c : columns_of(comparison)) {
    list += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", html(c.head), html(c.what));
  }
  return list;
}

// --- pictures ---------------------------------------------------------------------------------------------------

std::string figure(const ComparedMethod& method, const char* layer, const char* caption, const std::string& picture,
                   const std::filesystem::path& folder) {
  if (picture.empty()) return {};
  return fmt::format(R"(<figure><img data-layer="{}" alt="{}: {}" src="{}"><figcaption>{}</figcaption></figure>)"
                     "\n",
                     layer, html(method.title), caption, picture_uri(folder / picture), caption);
}

std::string pictures(const Comparison& comparison, const std::filesystem::path& folder) {
  std::string result;
  for (const ComparedMethod& m : comparison.methods) {
    result += fmt::format("<article id=\"picture-{0}\" data-id=\"{0}\" data-title=\"{1}\"><h3>{1}</h3>\n<p>{2}</p>\n",
                          html(m.id), html(m.title), html(m.what));
    if (!m.failed.empty()) {
      result += fmt::format("<p class=\"failed\">No picture: {}</p>\n", html(m.failed));
    } else {
      result += "<div class=\"layers\">\n" + figure(m, "picture", "picture", m.picture, folder) +
                figure(m, "error", "error map", m.error_map, folder) +
                figure(m, "flip", "FLIP map", m.flip_map, folder) + "</div>\n";
    }
    result += "</article>\n";
  }
  return result;
}

// --- words ------------------------------------------------------------------------------------------------------

std::string commands(const Comparison& comparison) {
  const auto command = [](const std::string& title, const std::string& line) {
    return fmt::format("<div class=\"command\"><h3>{}</h3><pre><code>{}</code></pre></div>\n", html(title), html(line));
  };
  std::string list = command("This comparison", comparison.command);
  for (const ComparedMethod& m : comparison.methods) {
    if (!m.command.empty()) list += command(m.title, m.command);
  }
  return list;
}

std::string summary(const Comparison& comparison) {
  std::size_t drawn = 0, frames = 0;
  for (const ComparedMethod& m : comparison.methods) {
    if (m.failed.empty() && !is_truth(comparison, m)) ++drawn;
    frames = std::max(frames, m.frames.size());
  }
  const std::string moving =
      comparison.fps > 0 ? fmt::format(", {} frames at {} a second", frames, number(comparison.fps, 0)) : "";
  return fmt::format(
      "{} method{} against a ray-traced truth of {} samples a pixel: the same scene, camera, extinction and "
      "reflectance, {}\u00A0\u00D7\u00A0{} pixels{}.",
      drawn, drawn == 1 ? "" : "s", comparison.truth_samples, comparison.width, comparison.height, moving);
}

std::string noise(const Comparison& comparison) {
  const PictureError& n = comparison.truth_noise;
  return fmt::format(
      R"(<p class="note"><b>The truth has noise of its own:</b> RMSE {}, FLIP {}, bias ±{}{} )"
      "(one half of its {} samples a pixel against the other, halved; the bias by the number of pixels). A figure not "
      "above that (marked ~) says nothing about the method, and neither does a difference between two methods that is "
      "smaller; more samples lower it.</p>",
      number(n.rmse, 4), number(n.flip, 4), number(n.bias, 5),
      comparison.fps > 0 ? ", flicker " + number(comparison.flicker_noise, 4) : "", comparison.truth_samples);
}

// Stops of the colours of the maps, for CSS.
std::string ramp_stops() {
  std::string stops;
  for (int i = 0; i <= 8; ++i) {
    const draw::Colour c = draw::ramp(static_cast<float>(i) / 8);
    stops += fmt::format("{}rgb({:.0f} {:.0f} {:.0f})", i == 0 ? "" : ", ", 255 * c.r, 255 * c.g, 255 * c.b);
  }
  return stops;
}

std::string frames_section(const Comparison& comparison) {
  const std::string curves = frame_curves(comparison);
  if (curves.empty()) return {};
  return "<section id=\"frames\">\n<h2>Frame by frame</h2>\n" + curves + "</section>\n";
}

std::string provenance(const Comparison& comparison) {
  const auto item = [](const char* name, const std::string& text) {
    return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, html(text));
  };
  return item("Program", "pelage " + comparison.revision) + item("Processor", comparison.cpu) +
         item("Threads", std::to_string(comparison.threads));
}

}  // namespace

std::string comparison_page(const Comparison& comparison, const std::filesystem::path& folder) {
  if (comparison.methods.empty()) throw InputError(folder.string(), "a comparison without methods has no page");
  return fill(web::compare_html, [&](std::string_view name) -> std::string {
    if (name == "name") return html(comparison.name);
    if (name == "style") return std::string(web::page_css) + std::string(web::compare_css);
    if (name == "script") return std::string(web::page_js) + std::string(web::compare_js);
    if (name == "summary") return summary(comparison);
    if (name == "width") return std::to_string(comparison.width);
    if (name == "height") return std::to_string(comparison.height);
    if (name == "error_scale") return number(comparison.error_scale, 2);
    if (name == "ramp") return ramp_stops();
    if (name == "table") return table(comparison);
    if (name == "definitions") return definitions(comparison);
    if (name == "noise") return noise(comparison);
    if (name == "bars") return stage_bars(comparison);
    if (name == "frames") return frames_section(comparison);
    if (name == "pictures") return pictures(comparison, folder);
    if (name == "commands") return commands(comparison);
    if (name == "provenance") return provenance(comparison);
    if (name == "scene") return html(comparison.scene);
    throw std::logic_error("compare.html names {{" + std::string(name) + "}}");
  });
}

}  // namespace pelage::app
