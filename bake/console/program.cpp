// Both programs' frame: options, log, threads, Ctrl-C, and the one place that turns exceptions into exit codes.
#include "pelage/console/program.h"

#include <oneapi/tbb/global_control.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <iostream>
#include <memory>
#include <new>

#include "pelage/data_schema/errors.h"

namespace pelage::console {
namespace {

CommonOptions options;
int exit_code = ok;
volatile std::sig_atomic_t interrupt_seen = 0;

/// SA_RESETHAND: a second Ctrl-C meets the default action and kills.
void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupt_seen = 1; };
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// A file that is mapped (a database, while it is read) and gets cut off by somebody else: say so and end. There is no
/// way back into SQLite from here; outputs are renamed only when complete.
void catch_cut_files() {
  struct sigaction action = {};
  action.sa_handler = [](int) {
    static constexpr char kText[] = "a file was cut off or failed while it was being read: restore it and run again\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kText, sizeof kText - 1);
    _exit(bad_input);
  };
  action.sa_flags = SA_RESETHAND;
  sigaction(SIGBUS, &action, nullptr);
}

void set_up_log(const std::string& name) {
  auto logger = std::make_shared<spdlog::logger>(name, std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%n: %^%l%$: %v");
  logger->set_level(spdlog::level::from_str(options.log_level));
  spdlog::set_default_logger(logger);
}

using ThreadLimit = std::unique_ptr<tbb::global_control>;
ThreadLimit limit_threads() {
  if (options.jobs == 0) return nullptr;
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(options.jobs));
}

/// --help shows every option's default. Where the description ends with it in brackets, the variable's own, 0 for "not
/// given", would only confuse; so does an empty list.
void capture_defaults(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    option->capture_default_str();
    if (option->get_description().ends_with(']') || option->get_default_str() == "[]") option->default_str("");
  }
  for (CLI::App* verb : app.get_subcommands({})) capture_defaults(*verb);
}

void prepare(CLI::App& app) {
  capture_defaults(app);
  if (app.get_option_no_throw("--version") == nullptr)
    app.set_version_flag("--version", app.get_name() + " " PELAGE_VERSION);
  if (!app.get_subcommands({}).empty()) app.require_subcommand(1);
}

int report(const CLI::App& app, std::string message, int code) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';  // one line, and no terminal codes out of somebody's file
  std::cerr << app.get_name() << ": " << message << '\n';
  return code;
}

/// "pelage render --help" for the verb that was being parsed.
std::string help_command(const CLI::App& app) {
  const std::vector<const CLI::App*> verbs = app.get_subcommands([](const CLI::App* a) { return a->parsed(); });
  return app.get_name() + (verbs.empty() ? "" : " " + verbs.front()->get_name()) + " --help";
}

int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  if (const auto rest = app.remaining(); !rest.empty() && app.get_subcommands().empty())
    return report(app, "there is no verb " + rest.front() + " (see " + help_command(app) + ")", usage);
  return report(app, std::string(error.what()) + " (see " + help_command(app) + ")", usage);
}

int run(CLI::App& app, int argc, char** argv) {
  ThreadLimit threads;
  app.parse_complete_callback([&] {  // after all options are read, before the verb's callback
    set_up_log(app.get_name());
    threads = limit_threads();
    catch_interrupts();
    catch_cut_files();
  });
  try {
    app.parse(argc, argv);
    std::cout.flush();
    return std::cout ? exit_code : report(app, "cannot write to standard output", failure);
  } catch (const CLI::ParseError& error) {
    return report_parse_error(app, error);
  } catch (const UsageError& error) {
    return report(app, error.what(), usage);
  } catch (const InputError& error) {
    return report(app, error.what(), bad_input);
  } catch (const GraphicsError& error) {
    return report(app, error.what(), no_opengl);
  } catch (const Interrupted& error) {
    return report(app, error.what(), interrupted);
  } catch (const std::bad_alloc&) {
    return report(app, "out of memory", failure);
  } catch (const std::exception& error) {  // OutputError among them
    return report(app, error.what(), failure);
  }
}

}  // namespace

const CommonOptions& common() noexcept {
  return options;
}

void add_common_options(CLI::App& verb) {
  const std::string group = "Common";
  verb.add_option("-j,--jobs", options.jobs, "Threads; 0: one per core")->check(CLI::Range(0, 1024))->group(group);
  verb.add_option("--progress", options.progress, "Progress on stderr")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->group(group);
  verb.add_option("--log-level", options.log_level, "Least important message on stderr")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->group(group);
  verb.add_flag("--json", options.json, "Results on stdout as JSON")->group(group);
}

int run_program(CLI::App& app, int argc, char** argv) {
  if (app.get_name().empty()) app.name("pelage");
  options = {};
  exit_code = ok;
  interrupt_seen = 0;
  prepare(app);
  return run(app, argc, argv);
}

bool is_interrupted() noexcept {
  return interrupt_seen != 0;
}

void throw_if_interrupted() {
  if (is_interrupted()) throw Interrupted("interrupted");
}

void set_exit_code(int code) noexcept {
  exit_code = code;
}

}  // namespace pelage::console
