// Work for other machines: independent tasks, each a range of the plan's cells. The distributing is Slurm's or make's.
#include <fstream>

#include "image/file.h"
#include "sweep/sweep.h"

namespace nf::editor {
namespace {

namespace fs = std::filesystem;

std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// Of make: $ is doubled, and # would begin a comment.
std::string make_quoted(const std::string& text) {
  std::string out;
  for (const char c : shell_quoted(text)) out += c == '$' ? "$$" : c == '#' ? "\\#" : std::string(1, c);
  return out;
}

class Emitter {
 public:
  Emitter(fs::path folder, const SweepSpec& spec, const CommonOptions& options)
      : folder_(std::move(folder)), cells_(plan_cells(spec).size()), group_(spec.group) {
    program_ = fs::read_symlink("/proc/self/exe").string();
    fs::create_directories(folder_ / "parts");
    if (!options.device.empty()) device_ = options.device;
    write("spec.json", spec.source.dump(1) + "\n");
  }

  size_t tasks() const { return (cells_ + group_ - 1) / group_; }

  void slurm() {
    const std::string program = shell_quoted(program_), folder = shell_quoted(folder_.string());
    const std::string head = "#!/bin/bash\n#SBATCH --ntasks=1\n#SBATCH --job-name=nearfield\n";
    const std::string sweep = program + " sweep " + folder + "/spec.json -o " + folder + device_flag(shell_quoted);
    write("references.sbatch",
          head + "#SBATCH --output=" + folder_.string() + "/references.log\n" + "exec " + sweep + " --cells 0:0\n");
    write("cells.sbatch",
          head + fmt::format("#SBATCH --array=0-{}\n#SBATCH --exclusive\n", tasks() - 1) +
              "#SBATCH --output=" + folder_.string() + "/parts/%a.log\n" +
              fmt::format("# {} cells, {} a task. One task a node at a time: others would disturb the times.\n"
                          "first=$((SLURM_ARRAY_TASK_ID * {}))\n",
                          cells_, group_, group_) +
              "exec " + sweep + fmt::format(" --cells $first:$((first + {}))\n", group_));
    write("submit.sh", "#!/bin/bash\n# Submits everything; join the parts afterwards with\n#   " + program +
                           " sweep --merge " + folder + "\nset -euo pipefail\ncd " + folder +
                           "\nfirst=$(sbatch --parsable references.sbatch)\n"
                           "sbatch --parsable --dependency=afterok:$first cells.sbatch\n");
    fs::permissions(folder_ / "submit.sh", fs::perms::owner_exec, fs::perm_options::add);
  }

  void make() {
    const std::string program = make_quoted(program_), folder = make_quoted(folder_.string());
    const std::string sweep =
        program + " sweep " + folder + "/spec.json -o " + folder + " --quiet" + device_flag(make_quoted);
    std::string text = fmt::format(
        "# {} cells in {} tasks. `make` runs one at a time; with -j they would disturb each other's times.\n"
        "# A task that was interrupted goes on where it was.\n",
        cells_, tasks());
    std::string names;
    for (size_t i = 0; i < tasks(); ++i) names += fmt::format(" parts/{}.done", i);
    text += "all: cells.jsonl\n.PHONY: all\n\ncells.jsonl:" + names + "\n\t" + program + " sweep --quiet --merge " +
            folder + "\n\nreferences.done:\n\t" + sweep + " --cells 0:0\n\ttouch $@\n";
    for (size_t i = 0; i < tasks(); ++i)
      text += fmt::format("\nparts/{}.done: | references.done\n\t{} --cells {}:{}\n\ttouch $@\n", i, sweep, i * group_,
                          (i + 1) * group_);
    write("Makefile", text);
  }

  std::vector<std::string> written;

 private:
  template <class Quote>
  std::string device_flag(Quote quote) const {
    return device_.empty() ? "" : " --device " + quote(device_);
  }
  void write(const std::string& name, const std::string& text) {
    image::write_file(folder_ / name, text);
    written.push_back((folder_ / name).string());
  }
  fs::path folder_;
  std::string program_, device_;
  size_t cells_, group_;
};

}  // namespace

std::vector<std::string> emit_jobs(const std::string& kind, const fs::path& folder, const SweepSpec& spec,
                                   const CommonOptions& options) {
  if (kind != "slurm" && kind != "make") fail(Exit::Usage, "--emit {}: there are slurm and make", kind);
  Emitter emitter(fs::absolute(folder).lexically_normal(), spec, options);
  if (kind == "slurm")
    emitter.slurm();
  else
    emitter.make();
  return emitter.written;
}

}  // namespace nf::editor
