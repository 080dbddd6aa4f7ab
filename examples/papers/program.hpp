// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_PROGRAM_HPP
#define PHIMIS_EXAMPLES_PAPERS_PROGRAM_HPP

#include <papers/output_folder.hpp>

#include <CLI/CLI.hpp>

#include <cstdint>
#include <cstdio>
#include <string>

// The command line of the programs that reproduce papers: examples/reproduce.sh calls each with the same options.

namespace papers {

struct arguments {
  std::string output = "reproduction";
  std::uint64_t seed = 1;
  bool quick = false;
  bool full = false;

  /// " --quick", " --full" or nothing.
  std::string effort() const { return full ? " --full" : quick ? " --quick" : ""; }
};

/// What --help says.
struct program_help {
  const char* name;
  const char* about;
  const char* quick;
  const char* full;
};

/// Adds the options to a program.
inline void add_options(CLI::App& app, arguments& to, const program_help& help) {
  app.add_option("--output", to.output, "folder for figures, their data and tables")->capture_default_str();
  app.add_option("--seed", to.seed, "of all random streams")->capture_default_str();
  auto* const quick = app.add_flag("--quick", to.quick, help.quick);
  app.add_flag("--full", to.full, help.full)->excludes(quick);
}

/// Parses the command line and runs reproduce(arguments), which returns the exit status; 2 where it cannot run.
template <class Reproduce>
int run_program(int argc, char** argv, const program_help& help, const Reproduce& reproduce) {
  arguments given;
  CLI::App app(help.about);
  add_options(app, given, help);
  try {
    app.parse(argc, argv);
    return reproduce(given);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "%s: %s; --help lists the options\n", help.name, error.what());
  } catch (const cannot_run& error) {
    std::fprintf(stderr, "%s: %s\n", help.name, error.what());
  }
  return 2;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_PROGRAM_HPP
