// Hard case 28: every number of every verb of both programs, as --help lists them, given NaN and infinity. Each is
// refused in one line, before any work.
#include <gmock/gmock.h>

#include <map>

#include "help.h"
#include "in_process.h"

namespace pelage::test {
namespace {

using Words = std::vector<std::string>;

/// What is no number where one belongs; empty where none does.
Words bad_values(const Option& o) {
  if (o.kind == "FLOAT") return {"nan", "-inf", "1e999"};
  if (o.kind == "INT" || o.kind == "UINT") return {"nan", "99999999999999999999"};
  if (o.about.find("x,y,z,x,y,z") != std::string::npos) return {"0,0,nan,0,0,0", "0,0,1,0,0,0,inf"};
  if (o.about.find("x,y,z") != std::string::npos) return {"1,nan,0", "0,1,-inf", "1,1e999,0"};
  if (o.about.find("WIDTHxHEIGHT") != std::string::npos) return {"nanx4", "4xinf", "99999999999x4"};
  if (o.about.find("metres per unit") != std::string::npos) return {"nan", "inf", "1e999"};
  if (o.about.find("METRIC=VALUE") != std::string::npos) return {"rmse=nan", "density-map:rmse=inf", "rmse=1e999"};
  if (o.about.find("i/n") != std::string::npos) return {"nan/2", "1/inf", "1/99999999999999999999"};
  return {};
}

/// A word for whatever a verb cannot do without.
std::string filler(const Option& o) {
  static const std::map<std::string, std::string> words{
      {"figure", "filter"}, {"database", "@no.hrir"}, {"shards", "@no.hrir"}, {"output", "@out.hair"}};
  if (o.positional) return words.contains(o.name) ? words.at(o.name) : "@h.obj";
  if (o.about.find("hair file to write") != std::string::npos) return "@out.hair";
  return o.about.find("icture") != std::string::npos ? "@out.png" : "@out.hrir";
}

class Numbers : public ::testing::TestWithParam<Program> {};

TEST_P(Numbers, NoneIsNanOrInfinite) {
  const TemporaryFolder folder;
  folder.write("h.obj", "v 0 0 0\nv 0 0.1 0\nv 0 0.2 0\nl 1 2 3\n");
  const Words verbs = verbs_of(GetParam(), folder);
  ASSERT_GE(verbs.size(), 5U);
  int numbers = 0;
  for (const std::string& verb : verbs) {
    const std::vector<Option> options = options_of(GetParam(), folder, verb);
    EXPECT_GE(options.size(), 4U) << verb << ": its help is read";
    for (const Option& o : options) {
      if (o.positional) continue;
      for (const std::string& value : bad_values(o)) {
        Words arguments{verb};
        if (verb == "tradeoff") arguments.insert(arguments.end(), {"@h.obj", "-o", "@out"});  // --list alone needs none
        for (const Option& needed : options) {
          if (!needed.required || needed.name == o.name) continue;
          if (!needed.positional) arguments.push_back(needed.name);
          arguments.push_back(filler(needed));
        }
        arguments.insert(arguments.end(), {o.name, value});
        // What belongs to a given mesh is refused for want of it first; so is a sequence that goes nowhere.
        if (verb == "groom" && o.about.find("with --on") != std::string::npos)
          arguments.insert(arguments.end(), {"--on", "@h.obj"});
        if (verb == "simulate" && o.name != "--hair-out") arguments.insert(arguments.end(), {"--hair-out", "@hair"});
        const ResultHere result = run_here(GetParam(), folder, arguments);
        const std::string what = verb + " " + o.name + " " + value + ": " + result.err;
        EXPECT_EQ(result.code, 2) << what;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << what;
        EXPECT_TRUE(result.err.find(o.name) != std::string::npos || result.err.find(value) != std::string::npos)
            << what;
        ++numbers;
      }
    }
  }
  EXPECT_GT(numbers, 30);
  std::printf("%s: %d numbers of %zu verbs\n", GetParam().name, numbers, verbs.size());
  EXPECT_EQ(folder.entries(), 1U) << "nothing was begun";
}

INSTANTIATE_TEST_SUITE_P(Programs, Numbers, ::testing::Values(kPelage, kBake),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace pelage::test
