// The command line's failures: the exit code, one line on stderr, nothing on stdout, no file left behind.
#include "cli_process.h"

namespace nf {
namespace {

class CliErrorTest : public CliTest {
 protected:
  // `words` fail with `code`, and the line holds `mention`.
  void expect(int code, const Words& words, const std::string& mention, const Words& environment = {}) const {
    const Outcome outcome = run(words, environment);
    const std::string command = fmt::format("nearfield {}", fmt::join(words, " "));
    EXPECT_EQ(outcome.code, code) << command << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << command;
    EXPECT_TRUE(outcome.err.starts_with("error: ")) << command << "\n" << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << command << "\n" << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with("\n")) << command;
    EXPECT_NE(outcome.err.find(mention), std::string::npos) << command << ": no '" << mention << "' in\n"
                                                            << outcome.err;
    EXPECT_EQ(written(), std::set<std::string>()) << command;
  }
  // The same for `render SCENE -o a.png --size 64x36` and more.
  void expect_render(int code, const Words& words, const std::string& mention, const Words& environment = {}) const {
    Words all = {"render", scene(), "-o", out("a.png"), "--size", "64x36"};
    all.insert(all.end(), words.begin(), words.end());
    expect(code, all, mention, environment);
  }
};

TEST_F(CliErrorTest, UnknownFlagsAndCommands) {
  expect_render(2, {"--nosuch"}, "--nosuch");
  expect_render(2, {"extra"}, "extra");
  expect(2, {"paint", scene()}, "paint");
  expect(2, {"info", "--nosuch"}, "--nosuch");
  expect(2, {"graph"}, "SCENE");
  expect(2, {"render"}, "SCENE");
  expect(2, {"render", scene()}, "--output");
}

TEST_F(CliErrorTest, BadSizes) {
  for (const char* size :
       {"0x0", "64x0", "20000x10", "10x20000", "abc", "10x", "x10", "10", "-4x4", "10x10x10", "10 x10", ""})
    expect(2, {"render", scene(), "-o", out("a.png"), "--size", size}, "size");
  expect(2, {"render", scene(), "-o", out("a.png")}, "size", {"NEARFIELD_SIZE=huge"});
}

TEST_F(CliErrorTest, BadValues) {
  expect_render(2, {"--frames", "0"}, "--frames");
  expect_render(2, {"--frames", "many"}, "--frames");
  expect_render(2, {"--seed", "-1"}, "--seed");
  expect_render(2, {"--fps", "-1"}, "--fps");
  expect_render(2, {"--timeout", "-1"}, "--timeout");
  expect_render(2, {"--timing", "sideways"}, "--timing");
  expect_render(2, {"--progress", "loud"}, "--progress");
  expect_render(2, {"--precision", "double"}, "--precision");
  expect_render(2, {"--set", "gi.radius=wide"}, "gi.radius");
  expect_render(2, {"--set", "gi.radius=-1"}, "gi.radius");
  expect_render(2, {"--set", "gi.slices=1.5"}, "gi.slices");
  expect_render(2, {"--set", "gi.radius"}, "gi.radius");
  expect_render(2, {"--mode", "loose"}, "--mode");
  expect_render(2, {"--technique", "none", "--mode", "paper"}, "paper");
  expect(2, {"graph", scene(), "--format", "xml"}, "--format");
}

TEST_F(CliErrorTest, BadOutputs) {
  expect(2, {"render", scene(), "-o", out("a.jpg")}, ".png or .exr");
  expect(2, {"render", scene(), "-o", out("a")}, ".png or .exr");
  expect_render(2, {"--aov", "gi"}, "--aov");
  expect(2, {"render", scene(), "-o", out("f_{frame}.png"), "--accumulate"}, "--accumulate");
}

TEST_F(CliErrorTest, UnknownNames) {
  expect_render(3, {"--set", "gi.radios=1"}, "'gi.radius'");
  expect_render(3, {"--technique", "voxels"}, "voxels");
  expect(3, {"render", scene(), "-o", out("a.exr"), "--size", "64x36", "--aov", "gi,shine"}, "shine");
  // Known, but gtao does not give it: found out with the device at hand.
  expect(3, {"render", scene(), "-o", out("a.exr"), "--size", "64x36", "--technique", "gtao", "--aov", "gi", "--quiet"},
         "gi");
  expect(3, {"info", "--params", "voxels"}, "voxels");
  expect(3, {"graph", scene(), "--technique", "voxels"}, "voxels");
}

TEST_F(CliErrorTest, BadScenes) {
  expect(3, {"render", "/no/such.glb", "-o", out("a.png")}, "/no/such.glb");
  expect(3, {"graph", "/no/such.glb"}, "/no/such.glb");
  expect(3, {"info", "--scene", "/no/such.glb"}, "/no/such.glb");
  const std::string whole = bytes_of(scene());
  ASSERT_GT(whole.size(), 1000u);
  const std::string half = input("half.glb", whole.substr(0, whole.size() / 2));
  expect(3, {"render", half, "-o", out("a.png")}, "half.glb");
  expect(3, {"render", input("empty.glb", ""), "-o", out("a.png")}, "empty.glb");
  expect(3, {"render", input("other.gltf", R"({"name": "not glTF"})"), "-o", out("a.png")}, "other.gltf");
  expect(3, {"render", input("text.gltf", "hello"), "-o", out("a.png")}, "text.gltf");
  expect(3, {"render", folder, "-o", out("a.png")}, "out");
}

TEST_F(CliErrorTest, BadViews) {
  expect_render(3, {"--view", "/no/such.json"}, "/no/such.json");
  expect_render(3, {"--view", input("v.json", R"({"camera": {"position": [0,1,3], "focus": 1}})")}, "focus");
  expect_render(3, {"--view", input("v.json", R"({"kamera": {}})")}, "kamera");
  expect_render(3, {"--view", input("v.json", "{")}, "v.json");
  expect_render(3, {"--view", "no such camera"}, "no such camera");
  expect_render(3, {"--view", "99"}, "99");
}

// Errors inside a preset name the preset.
TEST_F(CliErrorTest, BadPresets) {
  const auto preset = [&](const std::string& rest) {
    return input("p.json", R"({"schema": "nearfield.preset/1")" + rest + "}");
  };
  expect_render(3, {"--preset", "/no/such.json"}, "/no/such.json");
  expect_render(3, {"--preset", input("p.json", "{")}, "p.json");
  expect_render(3, {"--preset", input("p.json", R"({"technique": "vbgi"})")}, "schema");
  expect_render(3, {"--preset", input("p.json", R"({"schema": 1})")}, "schema");
  expect_render(3, {"--preset", input("p.json", "[]")}, "p.json");
  expect_render(3, {"--preset", preset(R"(, "colour": "red")")}, "colour");
  expect_render(3, {"--preset", preset(R"(, "technique": 7)")}, "technique");
  expect_render(3, {"--preset", preset(R"(, "seed": "one")")}, "seed");
  expect_render(3, {"--preset", preset(R"(, "seed": -1)")}, "seed");
  expect_render(3, {"--preset", preset(R"(, "seed": 4294967296)")}, "seed");
  expect_render(3, {"--preset", preset(R"(, "params": 1)")}, "p.json");
  expect_render(3, {"--preset", preset(R"(, "params": {"gi.radios": 1})")}, "p.json");
  expect_render(2, {"--preset", preset(R"(, "params": {"gi.radius": "wide"})")}, "p.json");
}

// One is found at once; of a folder that takes no files one hears when writing.
TEST_F(CliErrorTest, UnwritableOutputs) {
  expect(7, {"render", scene(), "-o", out("no/such/a.png"), "--size", "64x36"}, "no/such");
  expect(7, {"render", scene(), "-o", scene() + "/a.png", "--size", "64x36"}, "cornell.glb");
  expect(7, {"render", scene(), "-o", "/proc/a.png", "--size", "64x36", "--quiet"}, "/proc/a.png");
  expect(7, {"render", scene(), "-o", "/proc/a.exr", "--size", "64x36", "--quiet"}, "/proc/a.exr");
  expect_render(7, {"--quiet", "--json", out("no/such/a.json")}, "no/such");
  expect_render(7, {"--log-file", "/proc/a.log"}, "/proc/a.log");
}

TEST_F(CliErrorTest, NoSuchDevice) {
  expect_render(4, {"--device", "nosuch"}, "nosuch");
  expect_render(4, {"--device", "99"}, "99");
  expect_render(4, {}, "nosuch", {"NEARFIELD_DEVICE=nosuch"});
}

TEST_F(CliErrorTest, TimeLimit) {
  expect_render(6, {"--timeout", "0.001", "--frames", "100000", "--quiet"}, "time limit");
}

}  // namespace
}  // namespace nf
