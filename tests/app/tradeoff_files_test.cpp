// JSON and CSV of a trade-off, and rows read back: bit for bit, or with the key that is wrong.
#include "pelage/app/tradeoff_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "pelage/data_schema/errors.h"

namespace pelage::app {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// No two fields hold the same.
TradeoffRow full_row() {
  TradeoffRow row;
  row.id = "density-map.cells-128";
  row.knob = "density-map.cells";
  row.label = "128, \"printed\"";
  row.amount = 128.1;
  row.settings = {"shadow.density_map.resolution=128", R"(camera={"eye": [0, 1, 2]})"};
  row.command = "pelage render 'a \"hair\".json' --set x=1\n  --frame 2";
  row.paper = "Bertails2005";
  row.failed = "";
  row.origin = {"0123456789abcdef", 18446744073709551615U, "abc1234", "A CPU, \xC2\xB5", 12};
  row.error = 0.1;
  row.error_bar = 1e-300;
  row.others = {{"bias", -0.3}, {"p99", kNan}, {"max", kInfinity}};
  row.time = {1.0 / 3, 2.5e-7, 123456.789, 9};
  row.prepare_ms = 77.7;
  row.bytes = 9007199254740993U;  // no double
  row.picture = "density-map.cells-128.png";
  row.on_front = true;
  row.dominated_by = "default";
  return row;
}

json as_read(const TradeoffRow& row) {
  return json::parse(row_json(row).dump());
}

// Doubles by their bits, so that nothing compares as it is not.
void expect_same(const TradeoffRow& a, const TradeoffRow& b) {
  const auto bits = [](double x) { return std::isnan(x) ? 0 : std::bit_cast<std::uint64_t>(x); };
  EXPECT_EQ(std::tie(a.id, a.knob, a.label, a.settings, a.command, a.paper, a.failed, a.origin),
            std::tie(b.id, b.knob, b.label, b.settings, b.command, b.paper, b.failed, b.origin));
  EXPECT_EQ(std::tie(a.time.repeats, a.bytes, a.picture, a.on_front, a.dominated_by),
            std::tie(b.time.repeats, b.bytes, b.picture, b.on_front, b.dominated_by));
  for (double TradeoffRow::*field :
       {&TradeoffRow::amount, &TradeoffRow::error, &TradeoffRow::error_bar, &TradeoffRow::prepare_ms})
    EXPECT_EQ(bits(a.*field), bits(b.*field));
  for (double Times::*field : {&Times::min_ms, &Times::median_ms, &Times::max_ms})
    EXPECT_EQ(bits(a.time.*field), bits(b.time.*field));
  ASSERT_EQ(a.others.size(), b.others.size());
  for (std::size_t i = 0; i < a.others.size(); ++i) {
    EXPECT_EQ(a.others[i].first, b.others[i].first);
    EXPECT_EQ(bits(a.others[i].second), bits(b.others[i].second)) << a.others[i].first;
  }
}

std::string message(const json& document) {
  try {
    row_from_json(document, "rows/a.json");
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

Tradeoff tradeoff() {
  Tradeoff t;
  t.name = "Hair";
  t.command = "pelage tradeoff hair.json -o out";
  t.scene = R"({"hair": "hair.json"})";
  t.origin = {"00ff", 3, "abc", "CPU", 4};
  t.quick = true;
  Diagram d;
  d.id = "transmittance";
  d.error_name = "RMSE of T";
  d.curves = {{"density-map.cells", "Cells along the longest side.", "cells"}};
  TradeoffRow failed = full_row();
  failed.failed = "no memory, at all";
  failed.amount = kNan;
  d.rows = {full_row(), failed};
  d.slopes = {{"density-map.cells", "cells", -0.61, kNan, 2}};
  t.diagrams = {d, {}};
  return t;
}

TEST(TradeoffRow, ReadsBackAsItWas) {
  expect_same(row_from_json(as_read(full_row()), "f"), full_row());
  expect_same(row_from_json(row_json(full_row()), "f"), full_row());  // not by way of text
  expect_same(row_from_json(as_read({}), "f"), {});
}

TEST(TradeoffRow, ReadsBackWhatIsNotFinite) {
  for (const double value : {kNan, kInfinity, -kInfinity, -0.0, std::numeric_limits<double>::denorm_min()}) {
    TradeoffRow row = full_row();
    row.amount = row.error = row.error_bar = row.prepare_ms = row.time.min_ms = value;
    expect_same(row_from_json(as_read(row), "f"), row);
  }
}

TEST(TradeoffRow, ReadsBackFromAFile) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "pelage-tradeoff-row.json";
  TradeoffRow row = full_row();
  row.amount = kNan;
  write_row(row, file);
  expect_same(read_row(file), row);
  std::ofstream(file) << R"({"id": )";
  EXPECT_THROW(
      {
        try {
          read_row(file);
        } catch (const InputError& e) {
          EXPECT_THAT(e.what(), HasSubstr(file.string()));
          throw;
        }
      },
      InputError);
  std::filesystem::remove(file);
}

TEST(TradeoffRow, EveryKeyIsNeededAndNoOther) {
  const json good = as_read(full_row());
  EXPECT_EQ(good.size(), 18U);
  for (const auto& item : good.items()) {
    json bad = good;
    bad.erase(item.key());
    EXPECT_THAT(message(bad), AllOf(HasSubstr("rows/a.json"), HasSubstr("\"" + item.key() + "\" is missing")));
  }
  for (const std::string place : {"origin", "time"}) {
    for (const auto& item : good[place].items()) {
      json bad = good;
      bad[place].erase(item.key());
      EXPECT_THAT(message(bad), HasSubstr("\"" + place + "." + item.key() + "\" is missing"));
    }
  }
  json more = good;
  more["time"]["mean_ms"] = 1;
  EXPECT_THAT(message(more), AllOf(HasSubstr("rows/a.json"), HasSubstr("\"time.mean_ms\"")));
}

TEST(TradeoffRow, EveryKeyHoldsOneKindOfValue) {
  const json good = as_read(full_row());
  for (const auto& item : good.items()) {
    for (const json& wrong : {json(json::object()), json("word"), json(-1.5), json(true), json({1})}) {
      if (wrong.type() == item.value().type()) continue;
      if (wrong.is_number() && item.value().is_number_float()) continue;
      json bad = good;
      bad[item.key()] = wrong;
      EXPECT_THAT(message(bad), AllOf(HasSubstr("rows/a.json: \"" + item.key()), HasSubstr("must be")));
    }
  }
}

TEST(TradeoffRow, EdgesOfItsValues) {
  const auto with = [](const json::json_pointer& place, const json& value) {
    json document = as_read(full_row());
    document[place] = value;
    return message(document);
  };
  using P = json::json_pointer;
  EXPECT_THAT(with(P("/origin/threads"), -1), HasSubstr("\"origin.threads\" must be a count, not -1"));
  EXPECT_THAT(with(P("/time/repeats"), 2147483648U), HasSubstr("time.repeats"));
  EXPECT_THAT(with(P("/bytes"), 1e30), HasSubstr("\"bytes\""));
  EXPECT_THAT(with(P("/others/1/value"), "many"), HasSubstr("\"others.1.value\""));
  EXPECT_THAT(with(P("/others/0"), json({{"name", "bias"}})), HasSubstr("\"others.0\""));
  EXPECT_THAT(with(P("/settings/1"), 5), HasSubstr("\"settings.1\" must be text, not 5"));
  EXPECT_EQ(with(P("/amount"), nullptr), "accepted");
  EXPECT_THAT(message(json::array()), HasSubstr("a row must be an object"));
}

TEST(TradeoffFiles, JsonHoldsEverything) {
  const json document = json::parse(tradeoff_json(tradeoff()).dump());
  EXPECT_EQ(document["scene"]["hair"], "hair.json");
  EXPECT_EQ(document["origin"]["seed"], 3);
  EXPECT_TRUE(document["quick"]);
  ASSERT_EQ(document["diagrams"].size(), 2U);
  const json& d = document["diagrams"][0];
  EXPECT_EQ(d["curves"][0]["unit"], "cells");
  EXPECT_EQ(d["slopes"][0]["slope"], -0.61);
  EXPECT_TRUE(d["slopes"][0]["standard_error"].is_null());
  ASSERT_EQ(d["rows"].size(), 2U);
  expect_same(row_from_json(d["rows"][1], "f"), tradeoff().diagrams[0].rows[1]);
}

// Fields of RFC 4180, read the way the RFC says.
std::vector<std::vector<std::string>> read_csv(const std::string& text) {
  std::vector<std::vector<std::string>> lines{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool twice = quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"';
    if (twice)
      ++i, lines.back().back() += '"';
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && c == ',')
      lines.back().emplace_back();
    else if (!quoted && c == '\n')
      lines.push_back({""});
    else if (quoted || c != '\r')
      lines.back().back() += c;
  }
  lines.pop_back();  // after the last line's end
  return lines;
}

TEST(TradeoffFiles, CsvHasALineForEachRow) {
  const auto lines = read_csv(tradeoff_csv(tradeoff()));
  ASSERT_EQ(lines.size(), 3U);
  std::map<std::string, std::string> row, failed;
  for (std::size_t i = 0; i < lines[0].size(); ++i) {
    ASSERT_EQ(lines[1].size(), lines[0].size());
    ASSERT_EQ(lines[2].size(), lines[0].size());
    row[lines[0][i]] = lines[1][i];
    failed[lines[0][i]] = lines[2][i];
  }
  const std::map<std::string, std::string> expected{
      {"diagram", "transmittance"},
      {"id", "density-map.cells-128"},
      {"knob", "density-map.cells"},
      {"label", "128, \"printed\""},
      {"amount", "128.1"},
      {"paper", "Bertails2005"},
      {"settings", full_row().settings[0] + "; " + full_row().settings[1]},
      {"scene_hash", "0123456789abcdef"},
      {"seed", "18446744073709551615"},
      {"revision", "abc1234"},
      {"cpu", "A CPU, \xC2\xB5"},
      {"threads", "12"},
      {"min_ms", fmt::format("{}", 1.0 / 3)},
      {"median_ms", "2.5e-07"},
      {"max_ms", "123456.789"},
      {"repeats", "9"},
      {"prepare_ms", "77.7"},
      {"bytes", "9007199254740993"},
      {"error", "0.1"},
      {"error_bar", "1e-300"},
      {"others", "bias=-0.3; p99=nan; max=inf"},
      {"on_front", "true"},
      {"dominated_by", "default"},
      {"failed", ""},
      {"command", full_row().command}};
  EXPECT_EQ(row, expected);
  EXPECT_EQ(failed["failed"], "no memory, at all");
  EXPECT_EQ(failed["command"], full_row().command);
  for (const char* empty : {"amount", "min_ms", "bytes", "error", "others", "on_front", "dominated_by"})
    EXPECT_THAT(failed[empty], IsEmpty()) << empty;
}

}  // namespace
}  // namespace pelage::app
