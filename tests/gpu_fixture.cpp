// The GPU test fixture.
#include "gpu_fixture.h"

#include <cstdlib>
#include <fstream>
#include <unistd.h>

#include "core/log.h"

namespace nf::test {

namespace {

std::unique_ptr<gpu::Device> the_device;

// The device goes before the process's static objects do: the validation layer has some of its own.
class DeviceEnvironment : public testing::Environment {
  void TearDown() override { the_device.reset(); }
};
[[maybe_unused]] const auto* environment = testing::AddGlobalTestEnvironment(new DeviceEnvironment);

}  // namespace

gpu::Device& device() {
  if (!the_device) the_device = std::make_unique<gpu::Device>(gpu::DeviceOptions{.select = "", .validation = true});
  return *the_device;
}

void GpuTest::TearDown() {
  for (const std::string& message : device().take_messages()) ADD_FAILURE() << message;
  if (!folder_.empty()) std::filesystem::remove_all(folder_);
}

std::filesystem::path GpuTest::temporary(const std::string& name) {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  folder_ = std::filesystem::temp_directory_path() /
            fmt::format("nearfield-{}-{}-{}", info->test_suite_name(), info->name(), getpid());
  std::filesystem::create_directories(folder_);
  return folder_ / name;
}

scene::Scene GpuTest::load(const content::Builder& builder) {
  const std::filesystem::path path = temporary("scene.glb");
  builder.save(path);
  return scene::load_gltf(path);
}

Shot GpuTest::shoot(const scene::Scene& scene, const Request& request) {
  passes::Renderer renderer(device(), scene, request.graph);
  passes::FrameView view;
  view.camera = view.previous_camera = request.camera;
  view.size = request.size;
  view.seed = request.seed;
  Shot shot;
  for (uint32_t frame = 0; frame < request.frames; ++frame) {
    view.frame_index = frame;
    graph::Graph graph(renderer.executor().histories());
    const passes::FrameOutputs outputs = renderer.build(graph, view, request.settings);
    const int64_t mean = request.accumulate ? int64_t(frame) : -1;
    std::vector<std::string> names;
    for (const passes::Aov& aov : passes::aovs())
      if (const graph::Tex tex = renderer.add_layer(graph, outputs, aov, mean)) {
        graph.readback("layer", tex);
        names.emplace_back(aov.name);
      }
    graph.readback("picture", renderer.add_picture(graph, outputs, request.settings, mean));
    const size_t wanted = names.size() + 1;
    // Every other target that can hold a NaN.
    for (uint16_t r = 0; request.scan && r < graph.resources.size(); ++r) {
      const VkFormat format = graph.resources[r].desc.format;
      const bool is_float = format == VK_FORMAT_R16_SFLOAT || format == VK_FORMAT_R16G16_SFLOAT ||
                            format == VK_FORMAT_R16G16B16A16_SFLOAT || format == VK_FORMAT_R32_SFLOAT ||
                            format == VK_FORMAT_R32G32_SFLOAT || format == VK_FORMAT_R32G32B32A32_SFLOAT ||
                            format == VK_FORMAT_D32_SFLOAT;
      const graph::Lifetime lifetime = graph.resources[r].lifetime;
      if (is_float && lifetime != graph::Lifetime::HistoryPrev && lifetime != graph::Lifetime::Imported)
        graph.readback(graph.resources[r].name, graph.tex(r));
    }
    renderer.executor().run(graph, {.drop_barrier = request.drop_barrier});
    shot.times = renderer.executor().finish();
    const std::vector<graph::Readback> readbacks = renderer.executor().take_readbacks();
    for (size_t i = 0; i < readbacks.size(); ++i) {
      if (i == names.size()) {
        shot.picture = readbacks[i].texels;
        continue;
      }
      image::Image image{readbacks[i].desc.size.width, readbacks[i].desc.size.height, 0, {}};
      image.pixels = graph::to_floats(readbacks[i], image.channels);
      const image::NonFinite bad = image::find_non_finite(image);
      EXPECT_FALSE(bad.any()) << readbacks[i].name << ": " << bad.nan << " NaN, " << bad.inf << " infinite, first at "
                              << bad.first_x << "," << bad.first_y << " of frame " << frame;
      if (i < wanted) shot.layers[names[i]] = std::move(image);
    }
    view.previous_camera = view.camera;
  }
  shot.plan = renderer.executor().plan();
  return shot;
}

void EditedShadersTest::SetUp() {
  const std::filesystem::path data = temporary("data");
  shaders_ = data / "shaders";
  std::filesystem::create_directories(data);
  std::filesystem::copy(std::filesystem::path(NF_SOURCE_DIR) / "shaders", shaders_,
                        std::filesystem::copy_options::recursive);
  setenv("NEARFIELD_DATA_DIR", data.c_str(), 1);
}

void EditedShadersTest::TearDown() {
  unsetenv("NEARFIELD_DATA_DIR");
  GpuTest::TearDown();
}

std::string EditedShadersTest::text_of(const std::string& file) const {
  std::ifstream in(shaders_ / file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void EditedShadersTest::write(const std::string& file, const std::string& text) const {
  std::ofstream(shaders_ / file) << text;
}

void EditedShadersTest::edit(const std::string& file, const std::string& from, const std::string& to) const {
  std::string text = text_of(file);
  const size_t at = text.find(from);
  ASSERT_NE(at, text.npos) << file << " has no " << from;
  write(file, text.replace(at, from.size(), to));
}

void GpuGraphTest::start(std::initializer_list<std::pair<const char*, const char*>> shaders,
                         std::initializer_list<const ParamTable*> tables) {
  const std::filesystem::path folder = temporary("shaders");
  std::filesystem::create_directories(folder);
  std::filesystem::create_directory_symlink(std::filesystem::path(NF_SOURCE_DIR) / "shaders" / "common",
                                            folder / "common");
  for (const auto& [name, text] : shaders) std::ofstream(folder / name) << text;
  gpu::ShaderCompiler compiler(folder, {});
  for (const ParamTable* table : tables) compiler.add_table(*table);
  pipelines_ = std::make_unique<gpu::Pipelines>(device(), std::move(compiler), std::filesystem::path());
  executor_ = std::make_unique<graph::Executor>(device(), *pipelines_);
}

void GpuGraphTest::TearDown() {
  executor_.reset();
  pipelines_.reset();
  GpuTest::TearDown();
}

std::vector<float> GpuGraphTest::run(const graph::Graph& graph) {
  executor_->run(graph);
  uint32_t channels = 0;
  return graph::to_floats(executor_->take_readbacks().at(0), channels);
}

content::Builder small_room() {
  using glm::vec3;
  content::Builder b;
  const auto white = b.material({.base_color = vec3(0.7f)});
  b.room({0, 1, 0}, vec3(1, 1, 1), white);
  b.box({0.3f, 0.3f, -0.2f}, vec3(0.3f), 0.4f,
        b.material({.base_color = vec3(0.8f, 0.3f, 0.2f), .metallic = 0.5f, .roughness = 0.3f}));
  b.quad({-0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, -0.3f}, {0.3f, 1.98f, 0.3f}, {-0.3f, 1.98f, 0.3f},
         b.material({.emissive = vec3(8)}));
  b.point_light({-0.5f, 1.5f, 0.4f}, 1);
  b.directional_light({0.2f, -1, 0.1f}, 2);
  return b;
}

scene::Camera inside_small_room() {
  return look({-0.7f, 1.2f, 0.8f}, {0.2f, 0.7f, -0.3f}, 70);
}

passes::FrameView view_of_small_room(glm::uvec2 size, uint32_t frame) {
  passes::FrameView view;
  view.camera = view.previous_camera = inside_small_room();
  view.size = size;
  view.frame_index = frame;
  return view;
}

scene::Camera look(glm::vec3 eye, glm::vec3 target, float vfov_deg, glm::vec3 up) {
  return {.name = "test",
          .position = eye,
          .forward = glm::normalize(target - eye),
          .up = up,
          .vfov = glm::radians(vfov_deg)};
}

}  // namespace nf::test
