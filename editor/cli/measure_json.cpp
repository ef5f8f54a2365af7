// What a timing document says about how its figures were made.
#include <cstdlib>
#include <filesystem>

#include "cli/measure.h"
#include "image/file.h"

namespace nf::editor {
namespace {

using nlohmann::json;

std::string hash_of(const std::string& path) {
  uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a
  for (const uint8_t byte : image::read_file(path)) hash = (hash ^ byte) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

}  // namespace

json context_json(const gpu::Device& device, const capture::HostLoad& load, bool validation) {
  const BuildInfo build = build_info();
  const capture::Host host = capture::describe_host();
  const char* threads = std::getenv("LP_NUM_THREADS");
  return {
      {"date", capture::utc_date()},
      {"command", command_line()},
      {"cwd", std::filesystem::current_path().string()},
      {"app", {{"version", build.version}, {"git", build.git}, {"build", build.type}, {"compiler", build.compiler}}},
      {"host",
       {{"os", host.os},
        {"cpu", host.cpu},
        {"cores", host.cores},
        {"ram_mib", host.ram_mib},
        {"load_avg_start", load.average_start},
        {"load_avg_end", load.average_end},
        {"other_processes_cores", load.others}}},
      {"device",
       {{"name", device.info.name},
        {"type", device.info.type},
        {"software", device.facts.software},
        {"vendor_id", fmt::format("0x{:x}", device.properties.vendorID)},
        {"driver", device.info.driver},
        {"driver_info", device.info.driver_info},
        {"api", device.info.api},
        {"timestamp_period_ns", device.facts.timestamp_period},
        {"timestamps", device.facts.timestamp_mask != 0},
        {"calibrated_clock", device.facts.calibrated_clock},
        {"clock_policy", "unaltered"},
        {"env", {{"LP_NUM_THREADS", threads ? json(threads) : json(nullptr)}}}}},
      {"validation", validation},
      {"ui", false}};
}

json method_json(const MeasureOptions& o) {
  return {{"timing", o.timing == gpu::Timing::Serialize ? "serialize" : "overlap"},
          {"warmup_frames", o.warmup},
          {"settle_frames", std::min(o.warmup, Meter::settle_frames)},
          {"frames", o.frames},
          {"repeats", o.repeats},
          {"interleaved", o.interleave},
          {"block_frames", o.interleave ? std::min(o.block, o.frames) : o.frames},
          {"percentile", "nearest-rank"},
          {"clock", "gpu-timestamps"},
          {"frames_in_flight", 1},
          {"fps", o.fps},
          {"camera_path", o.path.has_value()}};
}

json settings_json(const Subject& subject, const passes::FrameView& view) {
  passes::FrameSettings settings = subject.settings;  // tables of parameters point into it
  return {{"technique", settings.technique->id},
          {"mode", subject.mode},
          {"size", {view.size.x, view.size.y}},
          {"seed", view.seed},
          {"params", params::to_json(settings.blocks(), true)},
          {"changed", params::to_json(settings.blocks())}};
}

json scene_json(const std::string& path, const std::string& view_name, uint64_t triangles, size_t lights) {
  return {
      {"path", path}, {"fnv1a64", hash_of(path)}, {"triangles", triangles}, {"lights", lights}, {"camera", view_name}};
}

capture::Circumstances circumstances(const gpu::Device& device, const capture::HostLoad& load,
                                     const MeasureOptions& options) {
  return {.load = load,
          .software_device = device.facts.software,
          .debug_build = build_info().debug,
          .validation = device.validation,
          .overlap = options.timing == gpu::Timing::Overlap,
          .timestamps = device.facts.timestamp_mask != 0};
}

}  // namespace nf::editor
