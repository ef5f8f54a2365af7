// Runs the built binary as a process of its own: no display, no settings of the user's, its streams in files.
#pragma once

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

extern char** environ;

namespace nf {

using Words = std::vector<std::string>;

struct Outcome {
  int code = -1;  // the exit code, or minus the signal that ended it
  std::string out, err;
  nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }  // discarded when it is none
};

class CliTest : public testing::Test {
 protected:
  void SetUp() override {
    base_ = std::filesystem::temp_directory_path() / fmt::format("nf_cli_test_{}", getpid());
    std::filesystem::remove_all(base_);
    folder = base_ / "out";
    std::filesystem::create_directories(folder);
    std::filesystem::create_directories(base_ / "in");
  }
  void TearDown() override { std::filesystem::remove_all(base_); }

  // The outputs' folder, and what is in it.
  std::filesystem::path folder;
  std::string out(const std::string& name) const { return (folder / name).string(); }
  std::set<std::string> written() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
  }
  // An input file with this content, in another folder.
  std::string input(const std::string& name, const std::string& content) const {
    const std::filesystem::path path = base_ / "in" / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  static std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static std::string scene() { return NF_BINARY_DIR "/content/cornell.glb"; }

  pid_t start(const Words& words, const Words& more_environment = {}) const {
    Words environment = more_environment;  // first: of two with one name the first counts
    environment.insert(environment.end(),
                       {"NEARFIELD_DATA_DIR=" NF_SOURCE_DIR, "XDG_CACHE_HOME=" NF_BINARY_DIR "/cli_test_cache"});
    for (char** entry = environ; *entry; ++entry) {
      const std::string_view text = *entry;
      bool kept = true;
      for (const char* dropped : {"DISPLAY=", "WAYLAND_DISPLAY=", "NEARFIELD_", "XDG_CACHE_HOME="})
        kept &= !text.starts_with(dropped);
      if (kept) environment.emplace_back(text);
    }
    Words arguments = {NF_BINARY_DIR "/nearfield"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    std::vector<char*> argv, envp;
    for (std::string& word : arguments) argv.push_back(word.data());
    for (std::string& entry : environment) envp.push_back(entry.data());
    argv.push_back(nullptr);
    envp.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    constexpr int create = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, (base_ / "stdout").c_str(), create, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, (base_ / "stderr").c_str(), create, 0600);
    pid_t pid = -1;
    EXPECT_EQ(posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), envp.data()), 0);
    posix_spawn_file_actions_destroy(&actions);
    return pid;
  }
  Outcome finish(pid_t pid) const {
    int status = 0;
    const auto start = std::chrono::steady_clock::now();
    pid_t ended = 0;
    while ((ended = waitpid(pid, &status, WNOHANG)) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (std::chrono::steady_clock::now() - start > std::chrono::seconds(150)) kill(pid, SIGKILL);
    }
    EXPECT_EQ(ended, pid);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), bytes_of(base_ / "stdout"),
            bytes_of(base_ / "stderr")};
  }
  Outcome run(const Words& words, const Words& environment = {}) const { return finish(start(words, environment)); }

  // content/schema/timing-1.json by Debian's python3-jsonschema: "" when the document is valid, else what is wrong.
  std::string schema_fault(const nlohmann::json& document) const {
    const std::string file = input("document.json", document.dump()), log = out("schema.log");
    const std::string script =
        "import json, sys, jsonschema\n"
        "load = lambda name: json.load(open(name))\n"
        "schema = load(sys.argv[2])\n"
        "jsonschema.Draft202012Validator.check_schema(schema)\n"
        "for e in jsonschema.Draft202012Validator(schema).iter_errors(load(sys.argv[1])): print(e.json_path, "
        "e.message[:200])\n";
    const std::string program = input("check.py", script);
    const std::string command = fmt::format(
        "/usr/bin/python3 {} {} " NF_SOURCE_DIR "/content/schema/timing-1.json > {} 2>&1", program, file, log);
    const int status = std::system(command.c_str());
    const std::string text = bytes_of(log);
    return status && text.empty() ? "no answer" : text;
  }

  // A small picture of the Cornell box; the process must succeed.
  Outcome render(const Words& words, const Words& environment = {}) const {
    Words all = {"render", scene(), "--size", "64x36"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = run(all, environment);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }

  // Waits until the process has a handler for SIGINT of its own.
  static bool wait_for_handler(pid_t pid) {
    for (int i = 0; i < 2000; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
      std::ifstream status(fmt::format("/proc/{}/status", pid));
      for (std::string line; std::getline(status, line);)
        if (line.starts_with("SigCgt:") && (std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1)) return true;
    }
    return false;
  }

  std::filesystem::path base_;
};

}  // namespace nf
