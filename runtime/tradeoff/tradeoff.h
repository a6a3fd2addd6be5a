// What `pelage tradeoff` finds out: for every point of every knob its error against an independent truth, its time and
// its bytes, in diagrams of one measure each (DESIGN section 9). Written as a page, JSON and CSV.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pelage {

/// Where and of what a row was measured.
struct Origin {
  std::string scene_hash;  // 16 hex digits: resolved scene and the bytes of the files that it names
  std::uint64_t seed = 1;
  std::string revision;  // of the program
  std::string cpu;
  int threads = 0;
  bool operator==(const Origin&) const = default;
};

/// Of one way to do the work, repeated.
struct Times {
  double min_ms = 0, median_ms = 0, max_ms = 0;
  int repeats = 0;
};

struct TradeoffRow {
  std::string id;                     // names its files: "density-map.cells-128", [a-z0-9.-]+
  std::string knob;                   // its name; "default": the program's own settings; "combined": several at once
  std::string label;                  // the value: "128"
  double amount = 0;                  // NaN where values have no order
  std::vector<std::string> settings;  // what differs from the scene (data_schema/scene_values.h)
  std::string command;                // shows it alone: pelage render ...
  std::string paper;                  // "Bertails2005": this is what that paper prints; or empty
  std::string failed;                 // not empty: why there are no figures; nothing below holds then
  Origin origin;
  double error = 0;      // in the diagram's unit
  double error_bar = 0;  // standard error of `error`, or what is known of the truth's own error
  std::vector<std::pair<std::string, double>> others;  // further figures: bias, p99, max, flip ...
  Times time;
  double prepare_ms = 0;     // once, before any frame: bake, fit, open
  std::uint64_t bytes = 0;   // most that is held or moved for it
  std::string picture;       // PNG in the folder, or empty
  bool on_front = false;     // no row of the diagram is as fast and as accurate and better in one
  std::string dominated_by;  // id of such a row, the nearest; empty on the front
};

/// Straight line through a knob's points in logarithms: error ~ against^slope.
struct Slope {
  std::string knob;
  std::string against;  // "cells": the knob's amounts in its unit, or "ms"
  double slope = 0;
  double standard_error = 0;  // NaN with two points
  int points = 0;             // that the line goes through: those whose error stands clear of its error bar
};

struct Curve {
  std::string knob, what, unit;  // as Knob has them
};

struct Diagram {
  std::string id;          // "transmittance"
  std::string title;       // "Shadows: transmittance at vertices"
  std::string error_name;  // "RMSE of T"
  std::string error_unit;  // "mm", or empty
  std::string time_name;   // "map built and read at all vertices"
  std::string truth;       // a sentence: what the error is measured against, with its own error
  std::vector<Curve> curves;
  std::vector<TradeoffRow> rows;
  std::vector<Slope> slopes;
};

struct Tradeoff {
  std::string name;     // of the hair
  std::string command;  // that made it
  std::string scene;    // resolved scene as JSON
  Origin origin;
  bool quick = false;
  std::vector<Diagram> diagrams;
};

}  // namespace pelage
