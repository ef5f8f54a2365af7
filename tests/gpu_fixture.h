// What GPU tests share: one device with validation on, rendering of a scene into layers, and the rule that any
// validation message and any NaN or infinity in any target fails the test.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "builder.h"
#include "frame.h"
#include "image/image.h"
#include "scene/gltf.h"
#include "scene/view.h"

namespace nf::test {

// One device a process: lavapipe's JIT and the pipeline caches stay warm.
gpu::Device& device();

struct Request {
  glm::uvec2 size{160, 90};
  scene::Camera camera;
  passes::FrameSettings settings;
  uint32_t frames = 1, seed = 1;
  bool accumulate = false;
  graph::ExecutorOptions graph;
  bool scan = true;  // read every float target back: nothing can share memory then
  int drop_barrier = -1;
};

struct Shot {
  std::map<std::string, image::Image> layers;  // by AOV name; "" is the final radiance
  std::vector<std::byte> picture;              // RGBA8
  graph::FrameResult times;
  graph::Plan plan;
  const image::Image& layer(const std::string& name) const { return layers.at(name); }
  float value(const std::string& name, glm::ivec2 pixel, uint32_t channel = 0) const {
    return layers.at(name).at(uint32_t(pixel.x), uint32_t(pixel.y), channel);
  }
};

class GpuTest : public testing::Test {
 protected:
  // Fails for every validation message of the test, unless it took them itself.
  void TearDown() override;

  // A file of its own for each test, removed with the test.
  std::filesystem::path temporary(const std::string& name);
  // Through a file and the importer, as a user's scene.
  scene::Scene load(const content::Builder& builder);
  // Renders and scans every float target of the frame for NaN and infinity.
  Shot shoot(const scene::Scene& scene, const Request& request);

 private:
  std::filesystem::path folder_;
};

// Renderers that are made in the test compile from a copy of all shaders, which the test may change.
class EditedShadersTest : public GpuTest {
 protected:
  void SetUp() override;
  void TearDown() override;
  std::string text_of(const std::string& file) const;
  void write(const std::string& file, const std::string& text) const;
  // In `file`, the first `from` becomes `to`.
  void edit(const std::string& file, const std::string& from, const std::string& to) const;
  std::filesystem::path shaders_;
};

// Graphs with shaders of the test's own, beside the engine's common ones.
class GpuGraphTest : public GpuTest {
 protected:
  // Name and text of each shader; tables for their parameter blocks.
  void start(std::initializer_list<std::pair<const char*, const char*>> shaders,
             std::initializer_list<const ParamTable*> tables = {});
  void TearDown() override;
  // Runs, and the floats of the first read-back.
  std::vector<float> run(const graph::Graph& graph);
  std::unique_ptr<gpu::Pipelines> pipelines_;
  std::unique_ptr<graph::Executor> executor_;
};

// A closed room with a box, a lamp, a point light and a sun through its walls; and a camera in it.
content::Builder small_room();
scene::Camera inside_small_room();
// Frame number `frame` of that camera at rest.
passes::FrameView view_of_small_room(glm::uvec2 size, uint32_t frame = 0);

scene::Camera look(glm::vec3 eye, glm::vec3 target, float vfov_deg, glm::vec3 up = {0, 1, 0});

}  // namespace nf::test
