// Every allocation fails once, or that and all later ones, in every reader and in the writer of databases:
// std::bad_alloc or a typed error comes out, nothing leaks, nothing terminates, and afterwards the same works.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <ostream>

#include "../data_schema/temporary.h"
#include "../fuzz/harness.h"
#include "../fuzz/tiny_database.h"
#include "faulty_memory.h"

namespace pelage {
namespace fuzz {
void PrintTo(const Harness& harness, std::ostream* out) {
  *out << harness.name;
}
}  // namespace fuzz

namespace {

using fuzz::Harness;
namespace fs = std::filesystem;

/// `action` with its k-th allocation failing. Says what came out, without allocating.
enum class Outcome { fine, refused, unexpected };
template <class Action>
Outcome run(const Action& action, long k, bool stay_broken) {
  Outcome outcome = Outcome::fine;
  faults::arm_memory(k, stay_broken);
  try {
    action();
  } catch (const std::bad_alloc&) {
    outcome = Outcome::refused;
  } catch (const InputError&) {
    outcome = Outcome::refused;
  } catch (const OutputError&) {
    outcome = Outcome::refused;
  } catch (...) {
    outcome = Outcome::unexpected;
  }
  faults::stop_memory();
  return outcome;
}

/// The allocations that fail: all of the first 100, then ever fewer.
long next(long k) {
  return k < 100 ? k + 1 : k + k / 20;
}

template <class Action>
void fail_each(const Action& action, bool stay_broken) {
  for (int warm = 0; warm < 2; ++warm) ASSERT_EQ(run(action, 0, false), Outcome::fine);  // what is made once is made
  faults::arm_memory(0, false);
  action();
  const long allocations = faults::allocations();
  for (long k = 1; k <= allocations; k = next(k)) {
    const long before = faults::live();
    const Outcome outcome = run(action, k, stay_broken);
    const bool in_json = faults::failed_in_json();
    const long leaked = faults::live() - before;
    ASSERT_NE(outcome, Outcome::unexpected) << "allocation " << k << " of " << allocations;
    ASSERT_TRUE(leaked == 0 || in_json) << leaked << " leaked, "
                                        << "allocation " << k << " of " << allocations;
  }
  EXPECT_EQ(run(action, 0, false), Outcome::fine);
}

class Memory : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    static const bool once = (faults::install_memory(), true);
    static_cast<void>(once);
  }
};

class ReaderMemory : public Memory, public testing::WithParamInterface<Harness> {};

TEST_P(ReaderMemory, EachAllocationMayFail) {
  std::vector<fs::path> files;
  const fs::path folder = fs::path(PELAGE_SOURCE_DIR "/tests/fuzz/corpus") / GetParam().name;
  if (fs::exists(folder)) std::ranges::copy(fs::directory_iterator(folder), std::back_inserter(files));
  std::ranges::sort(files);
  std::vector<std::string> inputs;
  if (GetParam().seeds != nullptr) inputs.push_back(GetParam().seeds().front());
  for (const fs::path& file : files) inputs.push_back(fuzz::bytes_of(file));
  inputs.resize(std::min<std::size_t>(inputs.size(), 3));
  for (const std::string& input : inputs)
    for (const bool stay_broken : {false, true}) fail_each([&] { GetParam().run(input); }, stay_broken);
}

INSTANTIATE_TEST_SUITE_P(Readers, ReaderMemory, testing::ValuesIn(fuzz::harnesses().begin(), fuzz::harnesses().end()),
                         [](const auto& each) { return std::string(each.param.name); });

class WriterMemory : public Memory {};

TEST_F(WriterMemory, EachAllocationMayFail) {
  const BakeSettings settings = fuzz::tiny_settings(Storage::u8, 3);
  const test::TemporaryFolder folder;
  fuzz::write_tiny_database(folder / "expected", settings);
  const std::string expected = test::text_of(folder / "expected");
  for (const bool stay_broken : {false, true}) {
    fail_each([&] { fuzz::write_tiny_database(folder / "x", settings); }, stay_broken);
    EXPECT_TRUE(test::text_of(folder / "x") == expected) << "resumed to other bytes";
  }
  EXPECT_EQ(folder.entries(), 2U);
}

}  // namespace
}  // namespace pelage
