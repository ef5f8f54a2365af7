// Documents with one thing wrong: each ends as one nf::Error that names the file and the problem.
#include <functional>
#include <gtest/gtest.h>
#include <limits>

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
using nf::test::u16;

struct BadFile {
  const char* name;
  const char* message;  // a part of the error
  std::function<void(Gltf&)> damage;
};

json& accessor(Gltf& file, int row) {
  return file.doc["accessors"][size_t(row)];
}
json& node(Gltf& file, int row) {
  return file.doc["nodes"][size_t(row)];
}

void add_png(Gltf& file, const Bytes& bytes) {
  add_picture(file, {{"uri", test::data_uri(bytes)}, {"name", "leaf"}});
}

void patch_float(Gltf& file, size_t offset, float value) {
  std::memcpy(file.bin.data() + offset, &value, sizeof value);
}

Bytes resized_png(uint32_t width, uint32_t height) {
  Bytes png = test::make_png(4, 4, {1, 2, 3, 4});
  for (size_t i = 0; i < 4; ++i) {
    png[16 + i] = uint8_t(width >> (24 - 8 * i));
    png[20 + i] = uint8_t(height >> (24 - 8 * i));
  }
  return png;
}

const std::vector<BadFile> bad_geometry = {
    {"no_asset", "not glTF", [](Gltf& f) { f.doc.erase("asset"); }},
    {"version_1", "glTF 1.0", [](Gltf& f) { f.doc["asset"]["version"] = "1.0"; }},
    {"version_number", "asset.version is not a text", [](Gltf& f) { f.doc["asset"]["version"] = 2; }},
    {"no_meshes", "no triangles", [](Gltf& f) { f.doc.erase("meshes"), node(f, 0).erase("mesh"); }},
    {"no_nodes", "no triangles", [](Gltf& f) { f.doc.erase("nodes"), f.doc.erase("scenes"); }},
    {"only_points", "no triangles", [](Gltf& f) { test::quad_primitive(f)["mode"] = 0; }},
    {"no_position", "no triangles", [](Gltf& f) { test::quad_primitive(f)["attributes"] = json::object(); }},
    {"required_extension", "requires the extension KHR_texture_basisu",
     [](Gltf& f) { f.doc["extensionsRequired"] = {"KHR_texture_basisu"}; }},
    {"count_too_large", "room for 4", [](Gltf& f) { accessor(f, 0)["count"] = 5; }},
    {"count_absurd", "room for 4", [](Gltf& f) { accessor(f, 0)["count"] = int64_t(1) << 50; }},
    {"count_overflow", "out of range", [](Gltf& f) { accessor(f, 0)["count"] = ~uint64_t(0); }},
    {"count_negative", "accessors[0].count", [](Gltf& f) { accessor(f, 0)["count"] = -1; }},
    {"count_fraction", "not a whole number", [](Gltf& f) { accessor(f, 0)["count"] = 1.5; }},
    {"count_missing", "accessors[0].count is missing", [](Gltf& f) { accessor(f, 0).erase("count"); }},
    {"zeros_absurd", "far more than its size explains",
     [](Gltf& f) { accessor(f, 0).erase("bufferView"), accessor(f, 0)["count"] = int64_t(1) << 40; }},
    {"offset_beyond", "room for 0", [](Gltf& f) { accessor(f, 0)["byteOffset"] = 1000000; }},
    {"offset_unaligned_beyond", "room for 3", [](Gltf& f) { accessor(f, 0)["byteOffset"] = 1; }},
    {"view_beyond_buffer", "bufferViews[0] ends", [](Gltf& f) { f.doc["bufferViews"][0]["byteLength"] = 100000; }},
    {"view_offset_huge", "bufferViews[0] ends",
     [](Gltf& f) { f.doc["bufferViews"][0]["byteOffset"] = (int64_t(1) << 53) - 1; }},
    {"view_of_no_buffer", "bufferViews[0].buffer is 3", [](Gltf& f) { f.doc["bufferViews"][0]["buffer"] = 3; }},
    {"stride_too_small", "byteStride", [](Gltf& f) { f.doc["bufferViews"][0]["byteStride"] = 8; }},
    {"stride_absurd", "byteStride", [](Gltf& f) { f.doc["bufferViews"][0]["byteStride"] = 4096; }},
    {"no_such_accessor", "POSITION is 17", [](Gltf& f) { test::quad_primitive(f)["attributes"]["POSITION"] = 17; }},
    {"negative_accessor", "POSITION is -1", [](Gltf& f) { test::quad_primitive(f)["attributes"]["POSITION"] = -1; }},
    {"no_such_view", "bufferView is 9", [](Gltf& f) { accessor(f, 0)["bufferView"] = 9; }},
    {"index_out_of_range", "only 4 vertices", [](Gltf& f) { f.bin[48] = 4; }},
    {"indices_as_float", "component type float", [](Gltf& f) { accessor(f, 1)["componentType"] = f32; }},
    {"indices_as_vec2", "components", [](Gltf& f) { accessor(f, 1)["type"] = "VEC2", accessor(f, 1)["count"] = 3; }},
    {"positions_as_u16", "component type u16", [](Gltf& f) { accessor(f, 0)["componentType"] = u16; }},
    {"positions_as_vec2", "components", [](Gltf& f) { accessor(f, 0)["type"] = "VEC2"; }},
    {"positions_as_mat4", "components", [](Gltf& f) { accessor(f, 0)["type"] = "MAT4", accessor(f, 0)["count"] = 0; }},
    {"unknown_type", "accessors[0].type is 'VEC7?VEC8'", [](Gltf& f) { accessor(f, 0)["type"] = "VEC7\nVEC8"; }},
    {"half_a_triangle", "no whole number of triangles", [](Gltf& f) { accessor(f, 1)["count"] = 5; }},
    {"position_nan", "not finite", [](Gltf& f) { patch_float(f, 4, std::numeric_limits<float>::quiet_NaN()); }},
    {"position_inf", "not finite", [](Gltf& f) { patch_float(f, 4, std::numeric_limits<float>::infinity()); }},
    {"position_huge", "beyond 1e9 m", [](Gltf& f) { patch_float(f, 4, 3e38f); }},
    {"attribute_count", "NORMAL has 2 elements",
     [](Gltf& f) {
       test::quad_primitive(f)["attributes"]["NORMAL"] = f.positions({{0, 0, 1}, {0, 0, 1}});
     }},
    {"sparse_out_of_range", "sparse index 4",
     [](Gltf& f) {
       const int rows = f.view({4, 0}), values = f.view(Bytes(12));
       accessor(f, 0)["sparse"] = {{"count", 1},
                                   {"indices", {{"bufferView", rows}, {"componentType", u16}}},
                                   {"values", {{"bufferView", values}}}};
     }},
    {"sparse_too_many", "sparse indices",
     [](Gltf& f) {
       accessor(f, 0)["sparse"] = {{"count", 2000000000},
                                   {"indices", {{"bufferView", 1}, {"componentType", u16}}},
                                   {"values", {{"bufferView", 1}}}};
     }},
    {"no_such_material", "material is 2, but the file has 0", [](Gltf& f) { test::quad_primitive(f)["material"] = 2; }},
    {"mode_unknown", "mode is 9", [](Gltf& f) { test::quad_primitive(f)["mode"] = 9; }},
    {"meshes_not_a_list", "meshes is not a list", [](Gltf& f) { f.doc["meshes"] = 3; }},
    {"mesh_not_an_object", "meshes[0] is not an object", [](Gltf& f) { f.doc["meshes"][0] = "mesh"; }},
    {"name_not_a_text", "nodes[0].name is not a text", [](Gltf& f) { node(f, 0)["name"] = 3; }},
};

const std::vector<BadFile> bad_nodes = {
    {"self_cycle", "cycle", [](Gltf& f) { node(f, 0)["children"] = {0}; }},
    {"cycle", "cycle",
     [](Gltf& f) {
       f.add("nodes", {{"children", {2}}});
       f.add("nodes", {{"children", {1}}});
     }},
    {"cycle_in_scene", "cycle",
     [](Gltf& f) {
       f.add("nodes", {{"children", {0}}});
       node(f, 0)["children"] = {1};
     }},
    {"two_parents", "two parents",
     [](Gltf& f) {
       f.add_root({{"children", {3}}});
       f.add_root({{"children", {3}}});
       f.add("nodes", {{"name", "child"}});
     }},
    {"root_with_parent", "two parents",
     [](Gltf& f) {
       f.add_root({{"children", {0}}});
     }},
    {"root_twice", "listed twice",
     [](Gltf& f) {
       f.doc["scenes"][0]["nodes"] = {0, 0};
     }},
    {"no_such_child", "nodes[0].children is 12", [](Gltf& f) { node(f, 0)["children"] = {12}; }},
    {"no_such_mesh", "nodes[0].mesh is 4", [](Gltf& f) { node(f, 0)["mesh"] = 4; }},
    {"no_such_scene", "scene is 5", [](Gltf& f) { f.doc["scene"] = 5; }},
    {"matrix_short", "list of 16 numbers",
     [](Gltf& f) {
       node(f, 0)["matrix"] = {1, 2, 3};
     }},
    {"matrix_projective", "not affine",
     [](Gltf& f) { node(f, 0)["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
    {"rotation_zero", "no quaternion",
     [](Gltf& f) {
       node(f, 0)["rotation"] = {0, 0, 0, 0};
     }},
    {"scale_huge", "not a finite number",
     [](Gltf& f) {
       node(f, 0)["scale"] = {1e300, 1, 1};
     }},
    {"transform_overflow", "not finite",
     [](Gltf& f) {
       node(f, 0)["scale"] = {1e30, 1e30, 1e30};
       node(f, 0)["children"] = {1};
       f.add("nodes", {{"scale", {1e30, 1e30, 1e30}}});
     }},
    {"far_away", "beyond 1e9 m",
     [](Gltf& f) {
       node(f, 0)["translation"] = {1e12, 0, 0};
     }},
    {"no_such_camera", "camera is 0", [](Gltf& f) { node(f, 0)["camera"] = 0; }},
    {"camera_fov", "yfov",
     [](Gltf& f) {
       node(f, 0)["camera"] = 0;
       f.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 1}}}});
     }},
    {"camera_near", "znear",
     [](Gltf& f) {
       node(f, 0)["camera"] = 0;
       f.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0}}}});
     }},
    {"no_such_light", "light is 1",
     [](Gltf& f) {
       f.doc["extensions"]["KHR_lights_punctual"]["lights"] = json::array({{{"type", "point"}}});
       node(f, 0)["extensions"]["KHR_lights_punctual"]["light"] = 1;
     }},
    {"light_type", "unknown type 'area'",
     [](Gltf& f) {
       f.doc["extensions"]["KHR_lights_punctual"]["lights"] = json::array({{{"type", "area"}}});
       node(f, 0)["extensions"]["KHR_lights_punctual"]["light"] = 0;
     }},
    {"light_negative", "intensity",
     [](Gltf& f) {
       f.doc["extensions"]["KHR_lights_punctual"]["lights"] = json::array({{{"type", "point"}, {"intensity", -1}}});
       node(f, 0)["extensions"]["KHR_lights_punctual"]["light"] = 0;
     }},
};

const std::vector<BadFile> bad_pictures = {
    {"missing", "missing.png', which is missing",
     [](Gltf& f) {
       add_picture(f, {{"uri", "missing.png"}});
     }},
    {"parent_folder", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "../x.png"}});
     }},
    {"parent_inside", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "a/../../x.png"}});
     }},
    {"parent_encoded", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "%2e%2e/x.png"}});
     }},
    {"slash_encoded", "hides a path separator",
     [](Gltf& f) {
       add_picture(f, {{"uri", "..%2fx.png"}});
     }},
    {"zero_encoded", "hides a path separator",
     [](Gltf& f) {
       add_picture(f, {{"uri", "x.png%00.jpg"}});
     }},
    {"percent_broken", "broken percent code",
     [](Gltf& f) {
       add_picture(f, {{"uri", "100%"}});
     }},
    {"absolute", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "/etc/passwd"}});
     }},
    {"backslash", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "..\\x.png"}});
     }},
    {"scheme_file", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "file:///etc/passwd"}});
     }},
    {"scheme_http", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "http://x.org/x.png"}});
     }},
    {"scheme_encoded", "leaves the scene's folder",
     [](Gltf& f) {
       add_picture(f, {{"uri", "file%3Ax.png"}});
     }},
    {"empty_uri", "empty URI",
     [](Gltf& f) {
       add_picture(f, {{"uri", ""}});
     }},
    {"folder_uri", "not a file",
     [](Gltf& f) {
       add_picture(f, {{"uri", "."}});
     }},
    {"base64_broken", "base64",
     [](Gltf& f) {
       add_picture(f, {{"uri", "data:image/png;base64,@@@@"}});
     }},
    {"base64_absent", "base64",
     [](Gltf& f) {
       add_picture(f, {{"uri", "data:image/png,xyz"}});
     }},
    {"neither", "either a uri or a bufferView",
     [](Gltf& f) {
       add_picture(f, {{"name", "x"}});
     }},
    {"not_a_picture", "image 0 'leaf' is neither PNG nor JPEG",
     [](Gltf& f) {
       add_png(f, {1, 2, 3, 4, 5});
     }},
    {"truncated", "image 0 'leaf'",
     [](Gltf& f) {
       Bytes png = test::make_png(64, 64, {1, 2, 3, 4});
       png.resize(png.size() / 2);
       add_png(f, png);
     }},
    {"header_only", "image 0 'leaf'",
     [](Gltf& f) {
       Bytes png = test::make_png(64, 64, {1, 2, 3, 4});
       png.resize(12);
       add_png(f, png);
     }},
    {"too_wide", "16384 a side is the limit", [](Gltf& f) { add_png(f, resized_png(16385, 1)); }},
    {"bomb", "but has only", [](Gltf& f) { add_png(f, resized_png(16384, 16384)); }},
    {"wrong_size", "image 0 'leaf'", [](Gltf& f) { add_png(f, resized_png(64, 64)); }},
    {"no_such_texture", "index is 5",
     [](Gltf& f) {
       f.add("materials", {{"normalTexture", {{"index", 5}}}});
     }},
    {"no_such_image", "textures[0].source is 1",
     [](Gltf& f) {
       f.add("textures", {{"source", 1}});
     }},
    {"no_source", "textures[0] has no picture",
     [](Gltf& f) {
       f.doc["textures"] = json::array({json::object()});
       f.add("materials", {{"emissiveTexture", {{"index", 0}}}});
     }},
    {"picture_view", "bufferView is 70",
     [](Gltf& f) {
       add_picture(f, {{"bufferView", 70}});
     }},
    {"alpha_mode", "alphaMode is 'GLASS'",
     [](Gltf& f) {
       f.add("materials", {{"alphaMode", "GLASS"}});
     }},
    {"factor_short", "list of 4 numbers",
     [](Gltf& f) {
       f.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1}}}}});
     }},
};

void expect_errors(const std::vector<BadFile>& table) {
  for (const BadFile& bad : table) {
    SCOPED_TRACE(bad.name);
    const Folder folder;
    Gltf file = test::make_quad();
    bad.damage(file);
    const std::string text = file.text();
    const std::string from_gltf = load_error(folder.write(std::string(bad.name) + ".gltf", text));
    EXPECT_NE(from_gltf.find(bad.message), std::string::npos) << "got: " << from_gltf;
    const std::string from_glb = load_error(folder.write(std::string(bad.name) + ".glb", file.glb()));
    EXPECT_NE(from_glb.find(bad.message), std::string::npos) << "got: " << from_glb;
  }
}

TEST(BadGltf, Geometry) {
  expect_errors(bad_geometry);
}
TEST(BadGltf, Nodes) {
  expect_errors(bad_nodes);
}
TEST(BadGltf, PicturesAndUris) {
  expect_errors(bad_pictures);
}

}  // namespace
