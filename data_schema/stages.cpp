#include "pelage/data_schema/stages.h"

#include <algorithm>

namespace pelage {

StageLedger::Timer::~Timer() {
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start_;
  ledger_.stages_[stage_].milliseconds += spent.count();
  ++ledger_.stages_[stage_].calls;
}

void StageLedger::begin_frame() noexcept {
  for (Stage& s : stages_) {
    s.milliseconds = 0;
    s.bytes = 0;
  }
}

std::size_t StageLedger::stage(const std::string& name) {
  auto it = std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == name; });
  if (it == stages_.end()) it = stages_.insert(stages_.end(), Stage{name});
  return static_cast<std::size_t>(it - stages_.begin());
}

StageLedger::Timer StageLedger::run(const std::string& name) {
  return {*this, stage(name)};
}

void StageLedger::add(const Stage& part) {
  Stage& whole = stages_[stage(part.name)];
  whole.milliseconds += part.milliseconds;
  whole.bytes += part.bytes;
  whole.calls += part.calls;
}

std::uint64_t StageLedger::calls(const std::string& name) const noexcept {
  const auto it = std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == name; });
  return it == stages_.end() ? 0 : it->calls;
}

}  // namespace pelage
