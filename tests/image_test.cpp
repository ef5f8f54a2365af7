// Files of pictures survive the way out and back, bad ones end in an Error, and the measures give known answers.
#include "image/image.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "image/file.h"

namespace nf::image {
namespace {

namespace fs = std::filesystem;
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class ImageTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / fmt::format("nf_image_test_{}", getpid());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  size_t files_in(const fs::path& where) const {
    return size_t(std::distance(fs::directory_iterator(where), fs::directory_iterator()));
  }
  fs::path folder;
};

// Values that a half holds exactly.
Image ramp(uint32_t width, uint32_t height, uint32_t channels, float scale = 0.25f) {
  Image image{.width = width, .height = height, .channels = channels, .pixels = {}};
  for (size_t i = 0; i < size_t(width) * height * channels; ++i)
    image.pixels.push_back((float(i % 1021) - 300.0f) * scale);
  return image;
}

Image8 ramp8(uint32_t width, uint32_t height, uint32_t channels) {
  Image8 image{.width = width, .height = height, .channels = channels, .pixels = {}};
  for (size_t i = 0; i < size_t(width) * height * channels; ++i) image.pixels.push_back(uint8_t(i * 37 + i / 251));
  return image;
}

// The exit code and the text of the Error that `action` must throw.
std::pair<Exit, std::string> error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    return {e.exit(), e.what()};
  }
  return {Exit::Ok, "nothing was thrown"};
}

void expect_input_error(const fs::path& path, const std::function<void(const fs::path&)>& read) {
  const auto [exit, text] = error_of([&] { read(path); });
  EXPECT_EQ(exit, Exit::Input) << text;
  EXPECT_NE(text.find(path.string()), std::string::npos) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

// Shorter versions of a good file, and versions with one byte turned over.
void expect_no_crash_on_damage(const fs::path& good, const std::function<void(const fs::path&)>& read) {
  const std::vector<uint8_t> bytes = read_file(good);
  const fs::path bad = good.parent_path() / "damaged";
  for (size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97) {
    write_file(bad, std::span(bytes).first(size));
    expect_input_error(bad, read);
  }
  for (size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 499) {
    std::vector<uint8_t> copy = bytes;
    copy[i] ^= 0xff;
    write_file(bad, copy);
    const auto [exit, text] = error_of([&] { read(bad); });
    EXPECT_TRUE(exit == Exit::Ok || exit == Exit::Input) << text;
  }
}

TEST_F(ImageTest, png_round_trip) {
  for (uint32_t channels : {1u, 3u, 4u}) {
    const Image8 image = ramp8(37, 19, channels);
    write_png(folder / "a.png", image);
    const Image8 back = read_png(folder / "a.png");
    EXPECT_EQ(back.width, 37u);
    EXPECT_EQ(back.height, 19u);
    EXPECT_EQ(back.channels, channels);
    EXPECT_EQ(back.pixels, image.pixels);
    write_png(folder / "b.png", image);
    EXPECT_EQ(read_file(folder / "a.png"), read_file(folder / "b.png"));
    EXPECT_EQ(read_file(folder / "a.png"), encode_png(image));
  }
}

TEST_F(ImageTest, png_damage) {
  write_png(folder / "a.png", ramp8(37, 19, 3));
  expect_no_crash_on_damage(folder / "a.png", [](const fs::path& path) { read_png(path); });
}

TEST_F(ImageTest, png_that_claims_to_be_huge) {
  std::vector<uint8_t> bytes = encode_png(ramp8(4, 4, 3));
  // 65536 x 65536, with the checksum of that header (CRC-32 of "IHDR" and its 13 bytes).
  const uint8_t header[] = {0, 1, 0, 0, 0, 1, 0, 0, 8, 2, 0, 0, 0};
  std::memcpy(bytes.data() + 16, header, sizeof header);
  uint32_t crc = 0xffffffffu;
  for (size_t i = 12; i < 29; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  crc = ~crc;
  for (size_t i = 0; i < 4; ++i) bytes[29 + i] = uint8_t(crc >> (24 - 8 * i));
  write_file(folder / "huge.png", bytes);
  expect_input_error(folder / "huge.png", [](const fs::path& path) { read_png(path); });
}

std::vector<Layer> some_layers() {
  return {{"", "RGB", ramp(33, 21, 3)},
          {"normal", "XYZ", ramp(33, 21, 3, 0.5f)},
          {"gi", "RGBA", ramp(33, 21, 4, 1)},
          {"depth", "V", ramp(33, 21, 1, 2)},
          {"velocity", "XY", ramp(33, 21, 2, 4)}};
}

TEST_F(ImageTest, exr_round_trip) {
  const std::vector<Layer> layers = some_layers();
  const std::map<std::string, std::string> header{
      {"command", "nearfield render \"a b\""}, {"a_name_of_more_than_thirty_one_letters", "long"}, {"seed", "7"}};
  for (Precision precision : {Precision::Half, Precision::Float}) {
    write_exr(folder / "a.exr", layers, header, precision);
    const ExrFile back = read_exr(folder / "a.exr");
    EXPECT_EQ(back.header, header);
    ASSERT_EQ(back.layers.size(), layers.size());
    const size_t sorted[] = {0, 3, 2, 1, 4};
    for (size_t i = 0; i < layers.size(); ++i) {
      const Layer &expected = layers[sorted[i]], &found = back.layers[i];
      EXPECT_EQ(found.name, expected.name);
      EXPECT_EQ(found.channels, expected.channels);
      EXPECT_EQ(found.image.width, 33u);
      EXPECT_EQ(found.image.height, 21u);
      EXPECT_EQ(found.image.pixels, expected.image.pixels) << expected.name;
    }
    write_exr(folder / "b.exr", layers, header, precision);
    EXPECT_EQ(read_file(folder / "a.exr"), read_file(folder / "b.exr"));
  }
  EXPECT_EQ(files_in(folder), 2u);
}

TEST_F(ImageTest, exr_float_is_exact_and_half_saturates) {
  const Image image{.width = 3, .height = 2, .channels = 1, .pixels = {0.1f, 70000, -1e9f, nan, infinity, 65504}};
  const std::vector<Layer> layers{{"depth", "V", image}};
  write_exr(folder / "f.exr", layers, {}, Precision::Float);
  const Image exact = read_exr(folder / "f.exr").layers.at(0).image;
  EXPECT_EQ(std::memcmp(exact.pixels.data(), image.pixels.data(), 6 * sizeof(float)), 0);

  write_exr(folder / "h.exr", layers, {}, Precision::Half);
  const std::vector<float> half = read_exr(folder / "h.exr").layers.at(0).image.pixels;
  EXPECT_NEAR(half[0], 0.1f, 0.1f / 2048);
  EXPECT_EQ(half[1], 65504);
  EXPECT_EQ(half[2], -65504);
  EXPECT_TRUE(std::isnan(half[3]));
  EXPECT_EQ(half[4], 65504);
  EXPECT_EQ(half[5], 65504);
}

TEST_F(ImageTest, exr_channels_come_back_in_the_usual_order) {
  // Two plain letters, a layer two deep, and a channel that is a word: as other programs write them. OpenEXR's own
  // writer is out of reach here, but a layer may be called anything.
  const std::vector<Layer> layers{{"View.Combined", "BGR", ramp(8, 4, 3)}, {"", "A", ramp(8, 4, 1)}};
  write_exr(folder / "a.exr", layers, {}, Precision::Float);
  const ExrFile back = read_exr(folder / "a.exr");
  ASSERT_EQ(back.layers.size(), 2u);
  EXPECT_EQ(back.layers[0].channels, "A");
  EXPECT_EQ(back.layers[1].name, "View.Combined");
  EXPECT_EQ(back.layers[1].channels, "RGB");
  EXPECT_EQ(back.layers[1].image.at(5, 2, 0), layers[0].image.at(5, 2, 2));
}

TEST_F(ImageTest, exr_damage) {
  write_exr(folder / "a.exr", some_layers(), {{"seed", "7"}}, Precision::Half);
  expect_no_crash_on_damage(folder / "a.exr", [](const fs::path& path) { read_exr(path); });
}

// A flat (not run-length encoded) picture of 2 x 1: (1, 0.5, 0.25) and black.
std::string small_hdr() {
  std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  const unsigned char pixels[] = {128, 64, 32, 129, 0, 0, 0, 0};
  return text.append(reinterpret_cast<const char*>(pixels), sizeof pixels);
}

// One of 16 x 4, run-length encoded: each component a single run, (0.5, 0.25, 1) everywhere.
std::string encoded_hdr() {
  std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 16\n";
  const unsigned char row[] = {2, 2, 0, 16, 128 + 16, 64, 128 + 16, 32, 128 + 16, 128, 128 + 16, 129};
  for (int y = 0; y < 4; ++y) text.append(reinterpret_cast<const char*>(row), sizeof row);
  return text;
}

void write_text(const fs::path& path, const std::string& text) {
  write_file(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

TEST_F(ImageTest, hdr) {
  write_text(folder / "a.hdr", small_hdr());
  const Image flat = read_hdr(folder / "a.hdr");
  EXPECT_EQ(flat.width, 2u);
  EXPECT_EQ(flat.height, 1u);
  EXPECT_EQ(flat.pixels, (std::vector<float>{1, 0.5f, 0.25f, 0, 0, 0}));

  write_text(folder / "b.hdr", encoded_hdr());
  const Image encoded = read_hdr(folder / "b.hdr");
  ASSERT_EQ(encoded.pixels.size(), 16u * 4 * 3);
  EXPECT_EQ(encoded.at(15, 3, 0), 0.5f);
  EXPECT_EQ(encoded.at(15, 3, 1), 0.25f);
  EXPECT_EQ(encoded.at(15, 3, 2), 1.0f);

  std::string endless = encoded_hdr();
  endless[endless.size() - 4] = 0;  // a copy of nothing
  write_text(folder / "c.hdr", endless);
  expect_input_error(folder / "c.hdr", [](const fs::path& path) { read_hdr(path); });
  for (const char* name : {"a.hdr", "b.hdr"})
    expect_no_crash_on_damage(folder / name, [](const fs::path& path) { read_hdr(path); });
}

TEST_F(ImageTest, readers_refuse_what_is_not_theirs) {
  write_text(folder / "empty", "");
  write_text(folder / "text", "This is not a picture, whatever its name says.\n");
  fs::create_directory(folder / "folder");
  for (const char* name : {"missing", "empty", "text", "folder", "missing/deeper"}) {
    expect_input_error(folder / name, [](const fs::path& path) { read_png(path); });
    expect_input_error(folder / name, [](const fs::path& path) { read_exr(path); });
    expect_input_error(folder / name, [](const fs::path& path) { read_hdr(path); });
  }
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  expect_input_error(folder / "pipe", [](const fs::path& path) { read_png(path); });
}

TEST_F(ImageTest, unwritable_targets_leave_nothing_behind) {
  const std::vector<Layer> layers{{"", "RGB", ramp(4, 4, 3)}};
  fs::create_directory(folder / "taken");
  write_text(folder / "file", "x");
  const fs::path long_name = folder / std::string(300, 'a');
  for (const fs::path& path : {folder / "no" / "such" / "a", folder / "taken", folder / "file" / "a", long_name}) {
    for (const auto& write : {std::function([&] { write_png(path, ramp8(4, 4, 3)); }),
                              std::function([&] { write_exr(path, layers, {}, Precision::Half); })}) {
      const auto [exit, text] = error_of(write);
      EXPECT_EQ(exit, Exit::Output) << text;
      EXPECT_TRUE(text.starts_with(fmt::format("cannot write '{}': ", path.string()))) << text;
      EXPECT_NE(text.find("; "), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
  }
  EXPECT_EQ(files_in(folder), 2u);
  EXPECT_EQ(files_in(folder / "taken"), 0u);
  EXPECT_EQ(read_file(folder / "file").size(), 1u);
}

TEST_F(ImageTest, a_full_device_is_reported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const auto [exit, text] = error_of([] { write_png("/dev/full", ramp8(4, 4, 3)); });
  EXPECT_EQ(exit, Exit::Output) << text;
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(ImageTest, writing_follows_links_and_replaces_files) {
  write_text(folder / "target", "old");
  fs::create_symlink("target", folder / "link");
  write_text(folder / "link", "new!");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "target").size(), 4u);
  EXPECT_EQ(files_in(folder), 2u);
}

TEST(Image, header_names_that_exr_keeps_for_itself) {
  const std::vector<Layer> layers{{"", "RGB", ramp(4, 4, 3)}};
  const fs::path path = fs::temp_directory_path() / "nf_never_written.exr";
  EXPECT_EQ(error_of([&] { write_exr(path, layers, {{"compression", "x"}}, Precision::Half); }).first, Exit::Output);
  EXPECT_FALSE(fs::exists(path));
}

TEST(Image, srgb_round_trip) {
  for (int i = 0; i <= 255; ++i) {
    const float encoded = float(i) / 255;
    EXPECT_EQ(std::lround(srgb_from_linear(linear_from_srgb(encoded)) * 255), i);
  }
  EXPECT_EQ(srgb_from_linear(0), 0);
  EXPECT_NEAR(srgb_from_linear(1), 1, 1e-6f);
  EXPECT_NEAR(linear_from_srgb(0.5f), 0.21404114f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.46135613f, 1e-6f);
}

TEST(Image, non_finite) {
  Image image = ramp(5, 4, 3);
  EXPECT_FALSE(find_non_finite(image).any());
  image.at(3, 1, 2) = infinity;
  image.at(1, 2, 0) = nan;
  image.at(4, 3, 1) = -infinity;
  const NonFinite found = find_non_finite(image);
  EXPECT_TRUE(found.any());
  EXPECT_EQ(found.nan, 1u);
  EXPECT_EQ(found.inf, 2u);
  EXPECT_EQ(found.first_x, 3u);
  EXPECT_EQ(found.first_y, 1u);
  EXPECT_EQ(found.first_channel, 2u);
}

TEST(Image, difference_known_answers) {
  const Image zero{.width = 2, .height = 2, .channels = 2, .pixels = std::vector<float>(8)};
  EXPECT_EQ(difference(zero, zero, 0).max_abs, 0);
  EXPECT_EQ(difference(zero, zero, 0).fraction_above, 0);

  Image other = zero;
  other.at(0, 0, 0) = 1;
  other.at(1, 0, 1) = -3;
  other.at(1, 0, 0) = 0.5f;
  const Difference d = difference(zero, other, 0.75f);
  EXPECT_DOUBLE_EQ(d.mean_abs, 4.5 / 8);
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(10.25 / 8));
  EXPECT_DOUBLE_EQ(d.max_abs, 3);
  EXPECT_EQ(d.worst_x, 1u);
  EXPECT_EQ(d.worst_y, 0u);
  EXPECT_DOUBLE_EQ(d.fraction_above, 0.5);

  other.at(0, 1, 0) = nan;
  EXPECT_EQ(difference(zero, other, 0).max_abs, double(infinity));
  EXPECT_EQ(difference(zero, other, 0).worst_y, 1u);
  EXPECT_EQ(error_of([&] { difference(zero, ramp(2, 3, 2), 0); }).first, Exit::Input);
  EXPECT_EQ(error_of([&] { difference(zero, ramp(2, 2, 1), 0); }).first, Exit::Input);
}

}  // namespace
}  // namespace nf::image
