// Files that are damaged, hostile or not there: truncated, linked to elsewhere. Nothing may crash.
#include <gtest/gtest.h>

#include "scene_files.h"

namespace {

using namespace nf;
using nf::test::add_picture;
using nf::test::Bytes;
using nf::test::f32;
using nf::test::Folder;
using nf::test::Gltf;
using nf::test::json;
using nf::test::load_error;

TEST(BadGltf, Files) {
  const Folder folder;
  const auto expect = [&](const std::string& error, const char* part) {
    EXPECT_NE(error.find(part), std::string::npos) << "got: " << error;
  };
  expect(load_error(folder.path() / "absent.glb"), "no such file");
  expect(load_error(folder.path()), "not a file");
  expect(load_error(folder.write("empty.gltf", "")), "empty");
  expect(load_error(folder.write("text.gltf", "hello")), "not valid JSON");
  expect(load_error(folder.write("json.gltf", "[1, 2]")), "not glTF");
  expect(load_error(folder.write("null.gltf", "null")), "not glTF");
  expect(load_error(folder.write("overflow.gltf", R"({"asset": {"version": "2.0"}, "scene": 1e999})")), "out of range");
  expect(load_error(folder.write("deep.gltf", std::string(100000, '['))), "nested deeper");
  expect(load_error(folder.write("utf8.gltf", "{\"asset\": \"\xff\xfe\"}")), "not valid JSON");

  const Bytes glb = test::make_quad().glb();
  expect(load_error(folder.write("tiny.glb", std::span(glb).first(10))), "truncated");
  for (size_t size = 12; size < glb.size(); size += 7) {
    expect(load_error(folder.write("cut.glb", std::span(glb).first(size))), "truncated");
  }
  Bytes changed = glb;
  changed[4] = 1;
  expect(load_error(folder.write("v1.glb", changed)), "version 1");
  changed = glb;
  changed[16] = 'X';
  expect(load_error(folder.write("chunk.glb", changed)), "not JSON");
  changed = glb;
  changed[15] = 0x7f;
  expect(load_error(folder.write("chunk_size.glb", changed)), "truncated");
}

TEST(BadGltf, Buffers) {
  const Folder folder;
  const auto error_with = [&](const json& buffer) {
    Gltf file = test::make_quad();
    file.doc["buffers"] = json::array({buffer});
    return load_error(folder.write("buffer.gltf", file.text()));
  };
  folder.write("short.bin", std::string(10, 'x'));
  EXPECT_NE(error_with({{"byteLength", 72}, {"uri", "absent.bin"}}).find("'absent.bin', which is missing"),
            std::string::npos);
  EXPECT_NE(error_with({{"byteLength", 72}, {"uri", "short.bin"}}).find("only 10"), std::string::npos);
  EXPECT_NE(error_with({{"byteLength", 72}}).find("no data"), std::string::npos);
  EXPECT_NE(error_with({{"byteLength", 72}, {"uri", test::data_uri(Bytes(9))}}).find("only 9"), std::string::npos);
  EXPECT_NE(error_with({{"byteLength", int64_t(1) << 52}, {"uri", "short.bin"}}).find("only 10"), std::string::npos);
  EXPECT_NE(error_with({{"byteLength", 72}, {"uri", "../short.bin"}}).find("leaves"), std::string::npos);
  EXPECT_NE(error_with({{"uri", "short.bin"}}).find("byteLength is missing"), std::string::npos);
}

TEST(BadGltf, LinksMustStayInside) {
  const Folder outside, folder;
  const std::filesystem::path secret = outside.write("secret.png", test::make_png(2, 2, {1, 2, 3, 4}));
  folder.write("real.png", test::make_png(2, 2, {1, 2, 3, 4}));
  std::filesystem::create_symlink(secret, folder.path() / "leaves.png");
  std::filesystem::create_directory_symlink(outside.path(), folder.path() / "sub");
  std::filesystem::create_symlink("real.png", folder.path() / "stays.png");
  const auto error_with = [&](const char* uri) {
    Gltf file = test::make_quad();
    add_picture(file, {{"uri", uri}});
    return load_error(folder.write("scene.gltf", file.text()));
  };
  EXPECT_NE(error_with("leaves.png").find("a link that leaves"), std::string::npos);
  EXPECT_NE(error_with("sub/secret.png").find("a link that leaves"), std::string::npos);
  EXPECT_EQ(error_with("stays.png"), "");
}

// Names of the file end up in messages; they must not break the line or drown it.
TEST(BadGltf, NamesStayOnOneLine) {
  const Folder folder;
  Gltf file = test::make_quad();
  add_picture(file, {{"uri", test::data_uri(Bytes{1, 2, 3})}, {"name", "a\nb\x1b[31m" + std::string(5000, 'x')}});
  EXPECT_NE(load_error(folder.write("scene.gltf", file.text())).find("'a?b?[31mx"), std::string::npos);
}

// The same mesh used again and again must not multiply into more memory than a file of this size explains.
TEST(BadGltf, InstancesAreBounded) {
  const Folder folder;
  Gltf file = test::make_quad();
  const json primitive = test::quad_primitive(file);
  for (int i = 0; i < 3000; ++i) file.doc["meshes"][0]["primitives"].push_back(primitive);
  for (int i = 0; i < 20000; ++i) file.add_root({{"mesh", 0}});
  EXPECT_NE(load_error(folder.write("many.glb", file.glb())).find("instances need more than"), std::string::npos);
}

}  // namespace
