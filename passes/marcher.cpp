// Sums of samples on the GPU, in rounds; the film is the CPU's.
#include "marcher.h"

#include "frame.h"
#include "gpu/upload.h"
#include "reference/columns.h"
#include "reference/film.h"
#include "scene/camera.h"

namespace nf::passes {
namespace {

// A row of shaders/marcher.comp's texels.
struct TexelRow {
  float w;
  glm::vec2 slope;
  glm::vec3 normal, radiance;
};

// Sums are floats: few enough of them, and no dispatch of seconds.
constexpr uint32_t most_in_a_round = 16;

}  // namespace

struct GpuMarcher::State {
  gpu::Device& device;
  reference::Film film;
  std::vector<glm::vec3> albedo;
  MarcherBlock block;
  uint32_t seed;
  bool with_sky;
  std::unique_ptr<gpu::Pipelines> pipelines;
  std::unique_ptr<graph::Executor> executor;
  gpu::Pipeline pipeline;
  gpu::Buffer texels, sky;

  State(gpu::Device& d, reference::Buffers buffers, const reference::MarchSettings& s)
      : device(d),
        film(reference::make_film(reference::march_layers(buffers, s), buffers.size, 1)),
        albedo(std::move(buffers.albedo)),
        seed(s.seed),
        with_sky(film.slots.size() > 3) {
    const reference::Screen screen(s.camera, buffers.size);
    block.view_from_world = scene::view_from_world(s.camera);
    block.scale = screen.scale, block.offset = screen.offset;
    block.size = buffers.size;
    block.near = s.camera.near;
    block.radius = std::isfinite(s.radius) ? s.radius : 0;  // 0: no end
    block.falloff = s.falloff, block.thickness = s.thickness;
    block.radius_mode = uint32_t(s.radius_mode), block.thickness_mode = uint32_t(s.thickness_mode);
    block.one_sided = s.one_sided, block.uniform_directions = s.uniform;
    block.independent = s.sampler == reference::SamplerKind::Independent;
    const std::vector<reference::Column> columns = reference::make_columns(buffers);
    std::vector<TexelRow> rows;
    for (size_t i = 0; i < columns.size(); ++i)
      rows.push_back({float(columns[i].w), columns[i].slope, buffers.normal[i], buffers.radiance[i]});
    texels = gpu::upload_table(device, rows, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "marcher.texels");
    scene::Environment map;
    if (with_sky) map = scene::as_map(*s.environment);
    block.sky_size = with_sky ? glm::ivec2(map.width, map.height) : glm::ivec2(0);
    block.sky_rotation = map.rotation;
    sky = gpu::upload_table(device, map.texels, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "marcher.sky");
    const std::filesystem::path cache = gpu::cache_folder();
    pipelines =
        std::make_unique<gpu::Pipelines>(device, make_shader_compiler(device, gpu::find_shader_folder(), cache), cache);
    pipeline = pipelines->compute("marcher.comp");
    executor = std::make_unique<graph::Executor>(device, *pipelines);
  }

  ~State() {
    executor.reset();
    gpu::destroy(device, texels);
    gpu::destroy(device, sky);
  }

  // Adds the samples [first, first + count) of one half to the film.
  void round(int half, uint32_t first, uint32_t count) {
    block.key = seed * 2 + uint32_t(half);
    block.first = first, block.count = count;
    graph::Graph graph;
    const graph::ImageDesc desc{{film.size.x, film.size.y}, VK_FORMAT_R32G32B32A32_SFLOAT};
    const graph::Tex light = graph.image("marcher.light", desc), open = graph.image("marcher.open", desc),
                     ambient = graph.image("marcher.ambient", desc);
    graph.compute("marcher", pipeline, "Random rays through the depth buffer")
        .in("texels", graph.import("marcher.texels", texels))
        .in("sky", graph.import("marcher.sky", sky))
        .out("light", light)
        .out("open", open)
        .out("ambient", ambient)
        .params(block)
        .over(light);
    for (const graph::Tex tex : {light, open, ambient}) graph.readback("readback.sums", tex);
    executor->run(graph);
    executor->finish();
    const std::vector<graph::Readback> sums = executor->take_readbacks();
    uint32_t channels = 0;
    const std::vector<float> l = graph::to_floats(sums[0], channels), o = graph::to_floats(sums[1], channels),
                             a = graph::to_floats(sums[2], channels);
    for (size_t i = 0; i < l.size() / 4; ++i) {
      double* to = film.at(i, half);
      for (size_t c = 0; c < 3; ++c) {
        to[film.slots[0].offset + c] += double(l[i * 4 + c]);
        to[film.slots[2].offset + c] += double(o[i * 4 + c]);
        if (with_sky) to[film.slots[3].offset + c] += double(a[i * 4 + c] * albedo[i][int(c)]);
      }
      to[film.slots[1].offset] += double(o[i * 4 + 3]);
    }
  }
};

GpuMarcher::GpuMarcher(gpu::Device& device, reference::Buffers buffers, const reference::MarchSettings& settings)
    : state_(std::make_unique<State>(device, std::move(buffers), settings)) {}
GpuMarcher::~GpuMarcher() = default;

void GpuMarcher::sample(uint32_t count) {
  reference::Film& film = state_->film;
  for (uint32_t left = (count + 1) / 2; left > 0;) {
    const uint32_t now = std::min(left, most_in_a_round);
    for (const int half : {0, 1}) state_->round(half, film.samples, now);
    film.samples += now;
    left -= now;
  }
}

uint32_t GpuMarcher::samples() const {
  return state_->film.samples * 2;
}
std::vector<image::Layer> GpuMarcher::layers() const {
  return reference::resolve(state_->film, -1);
}
std::vector<image::Layer> GpuMarcher::half(int which) const {
  return reference::resolve(state_->film, which);
}
std::vector<reference::Noise> GpuMarcher::noise() const {
  return reference::noise_of(state_->film);
}

}  // namespace nf::passes
