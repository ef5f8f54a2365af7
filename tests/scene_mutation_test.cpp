// Files damaged at random, by a seed: each loads or is refused, without a crash, a hang or an absurd allocation, and
// what loads can be animated. ctest makes 200 of a kind; for more:
//   NEARFIELD_MUTATIONS=2000 build/asan/tests/scene_mutation_test
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <malloc.h>
#include <new>
#include <random>
#include <sys/time.h>

#include "moving_files.h"
#include "scene/animation.h"
#include "scene/deform.h"

namespace {
std::atomic<size_t> live_bytes = 0, peak_bytes = 0;

void* counted(void* block) {
  if (!block) throw std::bad_alloc();
  const size_t now = live_bytes += malloc_usable_size(block);
  size_t peak = peak_bytes;
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now)) {
  }
  return block;
}
void release(void* block) {
  if (block) live_bytes -= malloc_usable_size(block);
  std::free(block);
}
}  // namespace

// Everything the importer and its libraries allocate with new, but for the pixels that stb decodes.
void* operator new(size_t size) {
  return counted(std::malloc(size));
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
  void* block = std::malloc(size);
  return block ? counted(block) : nullptr;
}
void* operator new(size_t size, std::align_val_t alignment) {
  const size_t a = size_t(alignment);
  return counted(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* block) noexcept {
  release(block);
}
void operator delete(void* block, size_t) noexcept {
  release(block);
}
void operator delete(void* block, const std::nothrow_t&) noexcept {
  release(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  release(block);
}
void operator delete(void* block, size_t, std::align_val_t) noexcept {
  release(block);
}

namespace {

using namespace nf;
using nf::test::Bytes;
using nf::test::Folder;
using nf::test::Gltf;
using nf::test::json;

// Chance without std's distributions, which differ between libraries.
struct Chance {
  std::mt19937 random;
  size_t below(size_t limit) { return limit == 0 ? 0 : random() % limit; }
};

size_t json_size(const Bytes& glb) {
  return glb[12] | size_t(glb[13]) << 8 | size_t(glb[14]) << 16 | size_t(glb[15]) << 24;
}

void collect_numbers(json& value, std::vector<json*>& numbers) {
  if (value.is_number()) numbers.push_back(&value);
  if (!value.is_structured()) return;
  for (json& member : value) collect_numbers(member, numbers);
}

// Huge counts, wrong rows, negative sizes: one number of the JSON becomes another.
Bytes change_number(const Bytes& glb, Chance& chance) {
  const size_t size = json_size(glb);
  Gltf file;
  file.doc = json::parse(glb.begin() + 20, glb.begin() + 20 + std::ptrdiff_t(size));
  file.bin.assign(glb.begin() + 28 + std::ptrdiff_t(size), glb.end());
  std::vector<json*> numbers;
  collect_numbers(file.doc, numbers);
  json& number = *numbers[chance.below(numbers.size())];
  const json values[] = {0,          1,          2,       3,    7,     -1,   255,  65535, 65536, 1000000, 0x7fffffff,
                         0xffffffff, 4294967296, 1 << 26, 1e18, 1e-30, 5120, 5121, 5123,  5125,  5126};
  number = chance.below(4) == 0 && number.is_number_integer() ? json(number.get<int64_t>() + 1)
                                                              : values[chance.below(std::size(values))];
  return file.glb();
}

// Words of the binary chunk change places, as wrong indices would.
void swap_words(Bytes& glb, Chance& chance) {
  const size_t first = (28 + json_size(glb) + 3) / 4, words = glb.size() / 4;
  if (words <= first + 1) return;
  const size_t a = first + chance.below(words - first), b = first + chance.below(words - first);
  std::swap_ranges(glb.begin() + std::ptrdiff_t(a * 4), glb.begin() + std::ptrdiff_t(a * 4 + 4),
                   glb.begin() + std::ptrdiff_t(b * 4));
}

Bytes mutate(const Bytes& glb, Chance& chance) {
  Bytes bytes = chance.below(2) ? change_number(glb, chance) : glb;
  for (size_t change = 1 + chance.below(4); change > 0 && chance.below(4) != 0; --change) {
    switch (chance.below(6)) {
      case 0:
        bytes[chance.below(bytes.size())] ^= uint8_t(1u << chance.below(8));
        break;
      case 1:
        bytes[chance.below(bytes.size())] = uint8_t(chance.below(256));
        break;
      case 2:
        swap_words(bytes, chance);
        break;
      // The part behind the JSON, where compressed data lies.
      case 3:
      case 4:
        bytes[bytes.size() - 1 - chance.below(bytes.size() / 2)] ^= uint8_t(1u << chance.below(8));
        break;
      default: {
        const size_t at = chance.below(bytes.size());
        const auto digit = std::find_if(bytes.begin() + std::ptrdiff_t(at), bytes.end(),
                                        [](uint8_t c) { return c >= '0' && c <= '9'; });
        if (digit != bytes.end()) *digit = uint8_t('0' + chance.below(10));
      }
    }
  }
  if (chance.below(12) == 0) bytes.resize(chance.below(bytes.size()));
  return bytes;
}

// What a viewer would do with a scene: play it, and deform everything.
void play(const std::filesystem::path& path) {
  try {
    scene::Scene scene = scene::load_gltf(path);
    for (const double time : {0.3, 0.9, 1e9}) scene::animate(scene, time);
    for (uint32_t i = 0; i < std::min<size_t>(scene.instances.size(), 20); ++i) {
      scene::deform(scene, i, scene::Moment::Now);
    }
    for (uint32_t variant = 0; variant < scene.variants.size(); ++variant) scene::select_variant(scene, variant);
  } catch (const Error&) {
  }
}

// A hang ends the process: SIGPROF after 5 s of processor time.
void watch_for_hangs(int seconds) {
  const itimerval timer{{0, 0}, {seconds, 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

void check_kind(Gltf file, uint32_t seed) {
  const char* count_text = std::getenv("NEARFIELD_MUTATIONS");
  const int count = count_text ? std::atoi(count_text) : 200;
  const Bytes glb = file.glb();
  const Folder folder;
  ASSERT_EQ(test::load_error(folder.write("whole.glb", glb)), "");
  Chance chance{std::mt19937(seed)};
  int loaded = 0;
  size_t worst = 0;
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    const Bytes bytes = mutate(glb, chance);
    const std::filesystem::path path = folder.write("mutant.glb", bytes);
    watch_for_hangs(5);
    peak_bytes = live_bytes.load();
    const size_t before = live_bytes;
    loaded += test::load_error(path).empty();
    worst = std::max(worst, peak_bytes - before);
    EXPECT_LE(peak_bytes - before, 4 * bytes.size() + (size_t(256) << 20));
    play(path);
  }
  watch_for_hangs(0);
  std::printf("%d of %d load; at most %.1f MiB for a file of %zu bytes\n", loaded, count, double(worst) / (1 << 20),
              glb.size());
  EXPECT_GT(loaded, 0);
  EXPECT_LT(loaded, count);
}

Gltf textured_file() {
  Gltf file = test::make_quad();
  test::quad_primitive(file)["attributes"]["TEXCOORD_0"] = file.attribute(test::quad_uvs, test::f32, "VEC2", 4);
  add_picture(file, {{"bufferView", file.view(test::make_png(8, 8, {9, 8, 7, 255}))}, {"mimeType", "image/png"}});
  file.doc["materials"][0]["normalTexture"] = {{"index", 0}};
  file.doc["materials"][0]["extensions"]["KHR_materials_specular"]["specularTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 1}}}}}};
  file.doc["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "a"}}, {{"name", "b"}}};
  json mappings = json::array({{{"material", 0}, {"variants", {0, 1}}}});
  test::quad_primitive(file)["extensions"]["KHR_materials_variants"]["mappings"] = mappings;
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
  file.add_root({{"camera", 0}, {"rotation", {0, 0, 0, 1}}, {"children", {2}}});
  file.add("nodes", {{"scale", {1, 2, 3}}});
  return file;
}

// Strips, interleaved and sparse data, bytes as indices, and a spline on the node.
Gltf sparse_file() {
  Gltf file;
  std::vector<float> mixed;
  for (const glm::vec3& p : test::quad_positions) mixed.insert(mixed.end(), {p.x, p.y, p.z, 0, 0, 1});
  const int view = file.view(test::bytes_of(mixed), 24);
  const int position = file.accessor(view, test::f32, "VEC3", 4),
            normal = file.accessor(view, test::f32, "VEC3", 4, 12);
  const int rows = file.view({1, 0, 3, 0}),
            values = file.view(test::bytes_of(std::vector<glm::vec3>{{5, 0, 0}, {0, 7, 0}}));
  file.doc["accessors"][0]["sparse"] = {{"count", 2},
                                        {"indices", {{"bufferView", rows}, {"componentType", test::u16}}},
                                        {"values", {{"bufferView", values}}}};
  const int indices = test::plain_accessor(file, std::vector<uint8_t>{0, 1, 3, 2}, test::u8, "SCALAR", 4);
  file.show({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", indices}, {"mode", 5}});
  std::vector<float> spline(27, 1);
  test::add_clip(file, 0, "translation", {0, 1, 2}, spline, "VEC3", 9, "CUBICSPLINE");
  return file;
}

TEST(Mutations, Textured) {
  check_kind(textured_file(), 1);
}
TEST(Mutations, Sparse) {
  check_kind(sparse_file(), 2);
}
TEST(Mutations, Skinned) {
  check_kind(test::arm_file(), 3);
}
TEST(Mutations, Morphed) {
  check_kind(test::morph_file(), 4);
}
TEST(Mutations, Meshopt) {
  check_kind(test::meshopt_file(test::make_grid(9)), 5);
}
TEST(Mutations, DracoEdgebreaker) {
  check_kind(test::draco_file(test::make_grid(9), draco::MESH_EDGEBREAKER_ENCODING), 6);
}
TEST(Mutations, DracoSequential) {
  check_kind(test::draco_file(test::make_grid(9), draco::MESH_SEQUENTIAL_ENCODING), 7);
}

}  // namespace
