// A small program on the console's frame, run by program_test.cpp as a process of its own.
#include <oneapi/tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <iostream>
#include <new>
#include <thread>

#include "pelage/console/options.h"
#include "pelage/console/output_file.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"

namespace {

using namespace pelage;

void throw_named(const std::string& name) {
  if (name == "input") throw InputError("file.json", "bad\x1b[31m value\nsecond line");
  if (name == "output") throw OutputError("out.png", "disk full");
  if (name == "usage") throw UsageError("--a and --b exclude each other");
  if (name == "graphics") throw GraphicsError("no OpenGL");
  if (name == "memory") throw std::bad_alloc();
  if (name == "other") throw std::runtime_error("else");
  if (name == "threshold") console::set_exit_code(console::threshold);
}

/// Writes half a file, says so, and works until Ctrl-C; `deaf` never looks.
void write_slowly(const std::string& file, bool deaf) {
  console::AtomicFile out(file);
  out.write("half");
  std::cout << "started" << std::endl;
  for (int i = 0; i < 2000; ++i) {
    if (!deaf) console::throw_if_interrupted();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  out.commit();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A probe", "probe");
  std::string error, file;
  float number = 0.25F;
  std::vector<double> list;
  bool deaf = false;
  CLI::App* verb = app.add_subcommand("go", "Goes");
  verb->add_option("--throw", error, "Error to throw");
  verb->add_option("--write", file, "File to write slowly");
  verb->add_option("--number", number, "A number")->check(console::finite(0, 1));
  verb->add_option("--list", list, "Numbers")->delimiter(',')->check(console::finite());
  verb->add_flag("--deaf", deaf, "Never looks for Ctrl-C");
  verb->callback([&] {
    throw_named(error);
    if (!file.empty()) write_slowly(file, deaf);
    console::Progress progress("probe", 40, "steps");
    for (std::uint64_t i = 0; i <= 40; ++i) {
      progress.update(i);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::cout << number << ' ' << list.size() << ' ' << console::common().json << ' '
              << oneapi::tbb::global_control::active_value(oneapi::tbb::global_control::max_allowed_parallelism)
              << '\n';
  });
  console::add_common_options(*verb);
  return console::run_program(app, argc, argv);
}
