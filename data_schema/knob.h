// Knob: a setting that trades accuracy for time, and the values worth measuring. Each module lists its own
// (<module>/knobs.h); `pelage tradeoff` sweeps them all (DESIGN section 9). A knob is data: values of a scene.
#pragma once

#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace pelage {

/// What a knob's error is measured in and against; each has a diagram of its own.
enum class MeasureKind {
  transmittance,  // T at vertices of the hair, against ray-traced T*
  records,        // radiance of the hairstyle's sectors out of a database, against tracing each
  picture,        // the scene's picture, against the ray-traced truth
  curve,          // the drawn polyline, against the curve through its vertices
  motion,         // places of the hair over a clip, against a converged run
  period          // of a hanging chain, against the zeros of Laguerre polynomials
};

struct KnobValue {
  std::string label;                                         // "128", "printed"
  double amount = std::numeric_limits<double>::quiet_NaN();  // place along the knob; NaN where values have no order
  std::vector<std::string> settings;                         // as scene_values.h has them
  int threads = 0;                                           // 0: all that the program may use
  std::string paper;                                         // "Bertails2005": this is what that paper prints
};

struct Knob {
  std::string name;  // "density-map.cells": [a-z0-9-]+(.[a-z0-9-]+)*
  std::string what;  // a sentence: what it does, what finer values buy
  std::string unit;  // of amounts, e.g. "cells"; empty for choices
  MeasureKind measure = MeasureKind::picture;
  std::vector<std::string> base;  // set before each value: what the curve stands on
  std::vector<KnobValue> values;  // ordered ones from coarse to fine, over the range that is worth having
};

/// Values of one numeric setting; labels and amounts are the numbers.
std::vector<KnobValue> numbers(const std::string& place, std::initializer_list<double> amounts);
/// Values of one setting that is a word or a switch.
std::vector<KnobValue> choices(const std::string& place, std::initializer_list<const char*> words);

}  // namespace pelage
