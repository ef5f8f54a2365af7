// `nearfield report`: timings and sweeps as one HTML file.
#include "report/report.h"

#include <fmt/format.h>
#include <memory>

#include "cli/options.h"

namespace nf::editor {

Command add_report(CLI::App& parent) {
  struct Options : CommonOptions {
    std::vector<std::string> inputs;
    std::string output;
  };
  auto state = std::make_shared<Options>();
  CLI::App* app = parent.add_subcommand("report", "One HTML file, which needs no network, from timings and sweeps");
  app->add_option("INPUT", state->inputs, "Files of bench --json, and folders of sweeps")->required();
  app->add_option("-o,--output", state->output, "The report")->type_name("FILE.html")->required();
  add_log_flags(*app, *state);
  app->footer(
      "Examples:\n  nearfield report times.json -o report.html\n  nearfield report sweep_folder -o report.html");
  return {app, [state] {
            start_log(*state);
            ReportData data;
            for (const std::string& input : state->inputs) read_report_input(input, data);
            for (const std::string& name : write_report(state->output, data)) fmt::print("{}\n", name);
            return int(Exit::Ok);
          }};
}

}  // namespace nf::editor
