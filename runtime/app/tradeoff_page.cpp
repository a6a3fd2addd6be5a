#include "pelage/app/tradeoff_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "pages_web.h"
#include "pelage/app/page_text.h"
#include "pelage/app/tradeoff_charts.h"

namespace pelage::app {
namespace {

std::string item(const std::string& name, const std::string& value) {
  return value.empty() ? "" : fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, value);
}

std::string link(const Diagram& diagram, const TradeoffRow& row) {
  return fmt::format(R"(<a href="#{0}" data-row="{0}">{1}</a>)", row_anchor(diagram, row), row_title(row));
}

std::string paper_note(const TradeoffRow& row) {
  return row.paper.empty() ? "" : fmt::format(R"( <span class="paper">{}</span>)", html(row.paper));
}

const TradeoffRow* row_of(const Diagram& diagram, const std::string& id) {
  const auto found =
      std::find_if(diagram.rows.begin(), diagram.rows.end(), [&](const TradeoffRow& r) { return r.id == id; });
  return found == diagram.rows.end() ? nullptr : &*found;
}

std::string spread(const Times& time) {
  return fmt::format("{} \u2013 {}", significant(time.min_ms), significant(time.max_ms));
}

// --- tables --------------------------------------------------------------------------------------------------------

std::string scrolled(const std::string& caption, const std::string& head, const std::string& rows) {
  return fmt::format(
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table>\n<thead><tr>{1}"
      "</tr></thead>\n<tbody>\n{2}</tbody></table></div>\n",
      caption, head, rows);
}

std::string heads(std::initializer_list<std::string> names) {
  std::string head;
  for (const std::string& name : names) head += R"(<th scope="col">)" + name + "</th>";
  return head;
}

std::string cells(std::initializer_list<std::string> texts) {
  std::string row;
  for (const std::string& text : texts) row += "<td>" + text + "</td>";
  return row;
}

std::string front_table(const Diagram& diagram) {
  std::vector<const TradeoffRow*> front;
  for (const TradeoffRow& row : diagram.rows) {
    if (row.on_front && row.failed.empty()) front.push_back(&row);
  }
  if (front.empty()) return {};
  std::stable_sort(front.begin(), front.end(),
                   [](const TradeoffRow* a, const TradeoffRow* b) { return a->time.median_ms < b->time.median_ms; });
  std::string rows;
  for (const TradeoffRow* row : front) {
    rows += fmt::format(R"(<tr data-row="{}"><th scope="row">{}{}</th>)", row_anchor(diagram, *row),
                        link(diagram, *row), paper_note(*row)) +
            cells({significant(row->time.median_ms), spread(row->time), error_text(diagram, *row), mib_text(row->bytes),
                   ms_text(row->prepare_ms)}) +
            "</tr>\n";
  }
  return "<div class=\"of-front\">\n<h3>The front, fastest first</h3>\n" +
         scrolled("Points of the front",
                  heads({"Point", "ms", "least \u2013 greatest", "error", "memory", "preparation"}), rows) +
         "</div>\n";
}

std::string slope_table(const Diagram& diagram) {
  std::string rows;
  for (const Slope& slope : diagram.slopes) {
    rows += fmt::format(R"(<tr><th scope="row">{}</th>)", html(slope.knob)) +
            cells({html(slope.against),
                   number(slope.slope, 2, true) +
                       (std::isfinite(slope.standard_error) ? " \u00B1 " + number(slope.standard_error, 2) : ""),
                   std::to_string(slope.points)}) +
            "</tr>\n";
  }
  if (rows.empty()) return {};
  return "<div class=\"slopes\">\n<h3>Slopes</h3>\n<p class=\"note\">error &prop; against<sup>slope</sup>, fitted in "
         "logarithms, \u00B1 standard error; two points have none. Points whose error does not stand clear of its "
         "error bar are left out.</p>\n" +
         scrolled("Slopes", heads({"Knob", "against", "slope", "points"}), rows) + "</div>\n";
}

std::string failed_list(const Diagram& diagram) {
  std::string items;
  for (const TradeoffRow& row : diagram.rows) {
    if (!row.failed.empty()) items += fmt::format("<li>{}: {}</li>\n", link(diagram, row), html(row.failed));
  }
  return items.empty() ? "" : "<div class=\"failures\">\n<h3>Failed</h3>\n<ul>\n" + items + "</ul></div>\n";
}

// --- one point -----------------------------------------------------------------------------------------------------

std::string standing(const Diagram& diagram, const TradeoffRow& row) {
  if (row.on_front) return "on the front of error and time";
  if (row.dominated_by.empty()) return "";
  const TradeoffRow* better = row_of(diagram, row.dominated_by);
  return "in error and time dominated by " + (better != nullptr ? link(diagram, *better) : html(row.dominated_by));
}

std::string settings_of(const TradeoffRow& row) {
  if (row.settings.empty()) return "as the scene has them";
  std::string list;
  for (const std::string& setting : row.settings) list += "<code>" + html(setting) + "</code>";
  return list;
}

std::string origin_words(const Origin& o) {
  return html(
      fmt::format("scene {}, pelage {}, {}, {} threads, seed {}", o.scene_hash, o.revision, o.cpu, o.threads, o.seed));
}

std::string figures_of(const Diagram& diagram, const TradeoffRow& row) {
  if (!row.failed.empty()) return item("Failed", html(row.failed));
  std::string list =
      item("Standing", standing(diagram, row)) +
      item(diagram.error_name.empty() ? "Error" : html(diagram.error_name), error_text(diagram, row)) +
      item("Time", fmt::format("{} ({}; {} times)", ms_text(row.time.median_ms), spread(row.time), row.time.repeats)) +
      item("Preparation", ms_text(row.prepare_ms)) + item("Memory", mib_text(row.bytes));
  for (const auto& [name, value] : row.others)
    list += item(html(name), std::isfinite(value) ? significant(value) : number(value, 0));
  return list;
}

std::string card(const Tradeoff& tradeoff, const Diagram& diagram, const TradeoffRow& row,
                 const std::filesystem::path& folder) {
  std::string text =
      fmt::format("<article id=\"{}\" class=\"card\">\n<h4>{}{}</h4>\n<dl>\n{}{}{}</dl>\n", row_anchor(diagram, row),
                  row_title(row), paper_note(row), figures_of(diagram, row), item("Settings", settings_of(row)),
                  row.origin == tradeoff.origin ? "" : item("Measured", origin_words(row.origin)));
  if (!row.command.empty())
    text += fmt::format("<div class=\"command\"><h5>Command</h5><pre><code>{}</code></pre></div>\n", html(row.command));
  if (!row.picture.empty() && row.failed.empty())
    text += fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n", row_title(row),
                        picture_uri(folder / row.picture));
  return text + "</article>\n";
}

std::string cards(const Tradeoff& tradeoff, const Diagram& diagram, const std::filesystem::path& folder) {
  std::string text;
  for (const TradeoffRow& row : diagram.rows) text += card(tradeoff, diagram, row, folder);
  return "<div class=\"all\">\n<h3>Every point</h3>\n<div class=\"cards\">\n" + text + "</div></div>\n";
}

// --- one diagram ---------------------------------------------------------------------------------------------------

// Pictures that a point's own is shown beside: of the program's defaults and of the least error.
std::string shown_beside(const Diagram& diagram) {
  const TradeoffRow *usual = nullptr, *best = nullptr;
  for (const TradeoffRow& row : diagram.rows) {
    if (!row.failed.empty() || row.picture.empty()) continue;
    if (row.knob == "default") usual = &row;
    if (std::isfinite(row.error) && (best == nullptr || row.error < best->error)) best = &row;
  }
  return (usual != nullptr ? fmt::format(R"( data-default="{}")", row_anchor(diagram, *usual)) : "") +
         (best != nullptr ? fmt::format(R"( data-best="{}")", row_anchor(diagram, *best)) : "");
}

std::string sentences(const Diagram& diagram) {
  std::string text;
  if (!diagram.time_name.empty())
    text += fmt::format("<p class=\"note\"><b>Time:</b> {}.</p>\n", html(diagram.time_name));
  if (!diagram.truth.empty())
    text += fmt::format("<p class=\"note truth\"><b>Truth:</b> {}</p>\n", html(diagram.truth));
  return text;
}

std::string section(const Tradeoff& tradeoff, const Diagram& diagram, int number, const std::filesystem::path& folder) {
  std::string text = fmt::format("<section class=\"diagram\" id=\"{}\" data-number=\"{}\"{}>\n<h2>{}</h2>\n",
                                 html(diagram.id), number, shown_beside(diagram), html(diagram.title)) +
                     sentences(diagram);
  if (diagram.rows.empty()) return text + "<p class=\"note\">Nothing was measured for this diagram.</p>\n</section>\n";
  return text + "<div class=\"tools\">" + axis_choice(number) +
         "</div>\n<div class=\"desk\">\n<div class=\"charts\">\n" + tradeoff_charts(diagram) +
         "<div class=\"panel\" tabindex=\"-1\" role=\"region\" aria-label=\"Chosen point\" hidden></div>\n</div>\n"
         "<div class=\"legend\">\n" +
         tradeoff_legend(diagram) + "</div>\n</div>\n" + front_table(diagram) + slope_table(diagram) +
         failed_list(diagram) + cards(tradeoff, diagram, folder) + "</section>\n";
}

std::string sections(const Tradeoff& tradeoff, const std::filesystem::path& folder) {
  std::string text;
  int number = 0;
  for (const Diagram& diagram : tradeoff.diagrams) text += section(tradeoff, diagram, number++, folder);
  return text;
}

std::string contents(const Tradeoff& tradeoff) {
  if (tradeoff.diagrams.size() < 2) return {};
  std::string items;
  for (const Diagram& d : tradeoff.diagrams)
    items += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", html(d.id), html(d.title));
  return "<nav aria-label=\"Diagrams\"><ol>\n" + items + "</ol></nav>\n";
}

// --- words ---------------------------------------------------------------------------------------------------------

std::string counted(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string summary(const Tradeoff& tradeoff) {
  std::size_t points = 0, failed = 0, elsewhere = 0;
  for (const Diagram& diagram : tradeoff.diagrams) {
    points += diagram.rows.size();
    for (const TradeoffRow& row : diagram.rows) {
      failed += row.failed.empty() ? 0 : 1;
      elsewhere += row.origin == tradeoff.origin ? 0 : 1;
    }
  }
  std::string text = fmt::format("{} in {}: error against time, memory and preparation, down and left is better.",
                                 counted(points, "point"), counted(tradeoff.diagrams.size(), "diagram"));
  if (failed > 0) text += fmt::format(" {} failed.", failed);
  if (elsewhere > 0)
    text += fmt::format(
        " {} measured with another scene, program, processor, seed or number of threads than the rest: their entries "
        "say which.",
        elsewhere);
  if (tradeoff.quick) text += " <b>A quick run: fewer points and repeats than a full one.</b>";
  return text;
}

std::string provenance(const Tradeoff& tradeoff) {
  const Origin& o = tradeoff.origin;
  return item("Scene hash", html(o.scene_hash)) + item("Program", "pelage " + html(o.revision)) +
         item("Processor", html(o.cpu)) + item("Threads", std::to_string(o.threads)) +
         item("Seed", std::to_string(o.seed));
}

}  // namespace

std::string tradeoff_page(const Tradeoff& tradeoff, const std::filesystem::path& folder) {
  return fill(web::tradeoff_html, [&](std::string_view name) -> std::string {
    if (name == "name") return html(tradeoff.name);
    if (name == "style") return std::string(web::page_css) + std::string(web::tradeoff_css);
    if (name == "script") return std::string(web::page_js) + std::string(web::tradeoff_js);
    if (name == "summary") return summary(tradeoff);
    if (name == "contents") return contents(tradeoff);
    if (name == "diagrams") return sections(tradeoff, folder);
    if (name == "command") return html(tradeoff.command);
    if (name == "provenance") return provenance(tradeoff);
    if (name == "scene") return html(tradeoff.scene);
    throw std::logic_error("tradeoff.html names {{" + std::string(name) + "}}");
  });
}

}  // namespace pelage::app
