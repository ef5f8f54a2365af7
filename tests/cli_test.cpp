// The command line at work, on the bundled Cornell box at tiny sizes: pictures, layers, numbers, precedence,
// interrupts.
#include "cli_process.h"
#include "image/image.h"

namespace nf {
namespace {

using nlohmann::json;

// The documented layers and their channels; "" is the final radiance.
const std::map<std::string, std::string> vbgi_layers = {
    {"", "RGB"},         {"direct", "RGB"},  {"direct_diffuse", "RGB"}, {"indirect", "RGB"},
    {"ambient", "RGB"},  {"gi", "RGB"},      {"gi_raw", "RGB"},         {"visibility", "V"},
    {"bent", "XYZ"},     {"albedo", "RGB"},  {"normal", "XYZ"},         {"depth", "V"},
    {"position", "XYZ"}, {"velocity", "XY"}, {"emissive", "RGB"},       {"radiance", "RGB"}};

const image::Layer& layer(const image::ExrFile& file, const std::string& name) {
  for (const image::Layer& l : file.layers)
    if (l.name == name) return l;
  static const image::Layer none;
  ADD_FAILURE() << "no layer " << name;
  return none;
}

TEST_F(CliTest, WritesAPicture) {
  const Outcome outcome = render({"-o", out("a.png")});
  const image::Image8 picture = image::read_png(out("a.png"));
  EXPECT_EQ(picture.width, 64u);
  EXPECT_EQ(picture.height, 36u);
  EXPECT_EQ(picture.channels, 3u);
  EXPECT_GT(std::set<uint8_t>(picture.pixels.begin(), picture.pixels.end()).size(), 20u);  // not one flat colour
  EXPECT_TRUE(outcome.out.ends_with(out("a.png") + "\n")) << outcome.out;
  EXPECT_NE(outcome.out.find("vbgi.trace"), std::string::npos);
  EXPECT_EQ(written(), std::set<std::string>{"a.png"});
}

TEST_F(CliTest, WritesAllLayers) {
  render({"-o", out("a.exr"), "--aov", "all"});
  const image::ExrFile file = image::read_exr(out("a.exr"));
  std::map<std::string, std::string> layers;
  for (const image::Layer& l : file.layers) {
    layers[l.name] = l.channels;
    EXPECT_EQ(l.image.width, 64u);
    EXPECT_EQ(l.image.height, 36u);
    EXPECT_FALSE(image::find_non_finite(l.image).any()) << l.name;
  }
  EXPECT_EQ(layers, vbgi_layers);
  for (const float depth : layer(file, "depth").image.pixels) EXPECT_GE(depth, 0);
  EXPECT_EQ(file.header.at("nearfield.seed"), "1");
  EXPECT_EQ(file.header.at("nearfield.complete"), "true");
  for (const char* key : {"nearfield.command", "nearfield.version", "nearfield.device"})
    EXPECT_TRUE(file.header.count(key)) << key;
}

TEST_F(CliTest, WritesTheLayersAskedFor) {
  render({"-o", out("a.exr"), "-o", out("a.png"), "--aov", "depth,gi,depth", "--precision", "float"});
  const image::ExrFile file = image::read_exr(out("a.exr"));
  ASSERT_EQ(file.layers.size(), 3u);
  EXPECT_EQ(file.layers[0].name, "");
  layer(file, "depth");
  layer(file, "gi");
  EXPECT_EQ(written(), (std::set<std::string>{"a.exr", "a.png"}));
  render({"-o", out("b.exr")});
  EXPECT_EQ(image::read_exr(out("b.exr")).layers.size(), 1u);
}

TEST_F(CliTest, JsonOnStdoutIsOneDocument) {
  const Outcome outcome = render({"-o", out("a.png"), "--json", "-", "--frames", "3", "--warmup", "1"});
  const json doc = outcome.json();
  ASSERT_TRUE(doc.is_object()) << outcome.out;
  EXPECT_EQ(doc["complete"], true);
  EXPECT_EQ(doc["size"], json({64, 36}));
  EXPECT_EQ(doc["technique"], "vbgi");
  EXPECT_EQ(doc["frames"], 3);
  EXPECT_EQ(doc["written"], json({out("a.png")}));
  std::set<std::string> passes;
  for (const json& pass : doc["passes"]) {
    passes.insert(pass["path"]);
    EXPECT_EQ(pass["gpu_ms"]["count"], 3) << pass;
    for (const char* key : {"min", "median", "p95", "p99", "max", "mean", "stddev", "mad"})
      EXPECT_GE(pass["gpu_ms"][key].get<double>(), 0) << key;
    EXPECT_LE(pass["gpu_ms"]["min"].get<double>(), pass["gpu_ms"]["max"].get<double>());
  }
  for (const char* name : {"gbuffer.opaque", "direct.light", "vbgi.trace", "tonemap", "readback"})
    EXPECT_TRUE(passes.count(name)) << name;
  for (const char* key : {"placed_bytes", "max_live_bytes", "unaliased_bytes"}) EXPECT_GT(doc["memory"][key], 0) << key;
  render({"-o", out("a.png"), "--json", out("a.json")});
  EXPECT_TRUE(json::parse(bytes_of(out("a.json")), nullptr, false).is_object());
}

TEST_F(CliTest, QuietPrintsPathsOnly) {
  const Outcome outcome = render({"-o", out("a.png"), "-o", out("b.exr"), "--quiet", "--frames", "2"});
  EXPECT_EQ(outcome.out, out("a.png") + "\n" + out("b.exr") + "\n");
  EXPECT_EQ(outcome.err, "");
}

TEST_F(CliTest, LogFileHoldsTheLog) {
  render({"-o", out("a.exr"), "--aov", "all", "--technique", "gtao", "--log-file", out("a.log"), "--quiet"});
  EXPECT_NE(bytes_of(out("a.log")).find("info: no layer 'gi'"), std::string::npos) << bytes_of(out("a.log"));
}

// As a file of its own or inside the preset: the same picture. A flag goes before both.
TEST_F(CliTest, APresetCanHoldItsView) {
  const std::string text =
      R"({"camera": {"position": [0.5, 1.2, 0.9], "target": [0, 0.9, -0.3]}, "directional": [{"direction": [0.3, -1, -0.5]}],
          "point": [{"position": [0.4, 1.7, 0.2], "intensity": 3, "direction": [0, -1, 0], "outer_cone_deg": 40}],
          "environment": {"color": [0.2, 0.3, 0.4]}})";
  const std::string view = input("v.json", text);
  const std::string preset =
      input("p.json", R"({"schema": "nearfield.preset/1", "scene": "elsewhere.glb", "view": )" + text + "}");
  render({"-o", out("a.png"), "--view", view});
  render({"-o", out("b.png"), "--preset", preset});
  render({"-o", out("c.png"), "--preset", preset, "--view", "0"});
  render({"-o", out("d.png"), "--view", "0"});
  EXPECT_EQ(bytes_of(out("a.png")), bytes_of(out("b.png")));
  EXPECT_EQ(bytes_of(out("c.png")), bytes_of(out("d.png")));
  EXPECT_NE(bytes_of(out("a.png")), bytes_of(out("c.png")));
}

// Flags, then the environment, then the preset, then the default.
TEST_F(CliTest, Precedence) {
  const std::string preset = input(
      "p.json",
      R"({"schema": "nearfield.preset/1", "size": "48x27", "seed": 7, "technique": "none", "params": {"gi.slices": 4}})");
  const auto size = [&](const Words& words, const Words& environment) {
    Words all = {"graph", scene(), "--format", "json"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = run(all, environment);
    const json doc = outcome.json();
    if (!doc.is_object()) return json(outcome.err);
    for (const json& resource : doc["resources"])
      if (resource["name"] == "gbuffer.depth") return resource["size"];
    return json("no gbuffer.depth");
  };
  EXPECT_EQ(size({}, {}), json({1280, 720}));
  EXPECT_EQ(size({"--preset", preset}, {}), json({48, 27}));
  EXPECT_EQ(size({}, {"NEARFIELD_PRESET=" + preset}), json({48, 27}));
  EXPECT_EQ(size({"--preset", preset}, {"NEARFIELD_SIZE=40x30"}), json({40, 30}));
  EXPECT_EQ(size({"--preset", preset, "--size", "32x18"}, {"NEARFIELD_SIZE=40x30"}), json({32, 18}));

  const Words words = {"render", scene(), "-o", out("a.png"), "--json", "-", "--preset", preset};
  const json doc = run(words, {"NEARFIELD_SEED=9"}).json();
  ASSERT_TRUE(doc.is_object());
  EXPECT_EQ(doc["seed"], 9);
  EXPECT_EQ(doc["technique"], "none");
  EXPECT_EQ(image::read_png(out("a.png")).width, 48u);
  const json flags =
      render({"-o", out("a.png"), "--json", "-", "--preset", preset, "--seed", "5"}, {"NEARFIELD_TECHNIQUE=vbgi"})
          .json();
  EXPECT_EQ(flags["seed"], 5);
  EXPECT_EQ(flags["technique"], "vbgi");
  EXPECT_EQ(image::read_png(out("a.png")).width, 64u);
}

// --set wins over the preset's value.
TEST_F(CliTest, ParametersReachThePicture) {
  const std::string preset =
      input("p.json", R"({"schema": "nearfield.preset/1", "params": {"tonemap.exposure_ev": 1}})");
  render({"-o", out("plain.png")});
  render({"-o", out("preset.png"), "--preset", preset});
  render({"-o", out("set.png"), "--preset", preset, "--set", "tonemap.exposure_ev=0"});
  EXPECT_NE(bytes_of(out("plain.png")), bytes_of(out("preset.png")));
  EXPECT_EQ(bytes_of(out("plain.png")), bytes_of(out("set.png")));
}

TEST_F(CliTest, PatternWritesEveryFrame) {
  render({"-o", out("f_{frame:02}.png"), "--frames", "3", "--warmup", "2"});
  EXPECT_EQ(written(), (std::set<std::string>{"f_00.png", "f_01.png", "f_02.png"}));
  EXPECT_NE(bytes_of(out("f_00.png")), bytes_of(out("f_01.png")));  // the noise moves on
  render({"-o", out("last.png"), "--frames", "3", "--warmup", "2"});
  EXPECT_EQ(bytes_of(out("f_02.png")), bytes_of(out("last.png")));
}

// A capture, or one line that says why there is none: RenderDoc 1.24 takes Vulkan 1.3 away from Mesa's software device.
TEST_F(CliTest, RenderDocCapturesAFrame) {
  const Outcome outcome =
      run({"render", scene(), "--size", "64x36", "-o", out("a.png"), "--frames", "3", "--renderdoc", "1"});
  if (outcome.code == 4) {
    EXPECT_NE(outcome.err.find("RenderDoc's layer lets through 1."), std::string::npos) << outcome.err;
  } else {
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::vector<std::string> captures;
    for (const std::string& name : written())
      if (name.ends_with(".rdc")) captures.push_back(out(name));
    ASSERT_EQ(captures.size(), 1u);
    EXPECT_NE(outcome.out.find(captures[0]), std::string::npos) << outcome.out;
    EXPECT_EQ(bytes_of(captures[0]).substr(0, 4), "RDOC");
  }
  // The loader finds no library of this name here.
  std::filesystem::create_directories(base_ / "empty");
  std::ofstream(base_ / "empty" / "librenderdoc.so") << "none";
  const Outcome missing = run({"render", scene(), "-o", out("b.png"), "--size", "64x36", "--renderdoc", "0"},
                              {"LD_LIBRARY_PATH=" + (base_ / "empty").string()});
  EXPECT_EQ(missing.code, 4);
  EXPECT_NE(missing.err.find("librenderdoc.so is not there"), std::string::npos) << missing.err;
  EXPECT_EQ(run({"render", scene(), "-o", out("b.png"), "--frames", "2", "--renderdoc", "2"}).code, 2);
}

TEST_F(CliTest, SameCommandSameBytes) {
  for (const char* name : {"a", "b"})
    render({"-o", out(name + std::string(".exr")), "-o", out(name + std::string(".png")), "--aov", "all", "--frames",
            "2"});
  EXPECT_EQ(bytes_of(out("a.png")), bytes_of(out("b.png")));
  EXPECT_EQ(bytes_of(out("a.exr")), bytes_of(out("b.exr")));
  render({"-o", out("c.exr"), "-o", out("c.png"), "--aov", "all", "--frames", "2", "--seed", "2"});
  EXPECT_NE(bytes_of(out("a.png")), bytes_of(out("c.png")));
  const image::ExrFile a = image::read_exr(out("a.exr")), c = image::read_exr(out("c.exr"));
  EXPECT_NE(layer(a, "gi_raw").image.pixels, layer(c, "gi_raw").image.pixels);
  EXPECT_EQ(layer(a, "depth").image.pixels, layer(c, "depth").image.pixels);
}

TEST_F(CliTest, GraphSwitchesDoNotChangeThePicture) {
  const auto picture = [&](const Words& words) {
    Words all = {"-o", out("s.png"), "--frames", "2", "--accumulate"};
    all.insert(all.end(), words.begin(), words.end());
    render(all);
    return image::read_png(out("s.png")).pixels;
  };
  const auto expected = picture({});
  for (const Words& words : {Words{"--no-alias"}, Words{"--poison"}, Words{"--poison=handover"},
                             Words{"--barriers", "each"}, Words{"--layouts", "general"}, Words{"--order-seed", "3"}})
    EXPECT_EQ(picture(words), expected) << words[0];
  EXPECT_EQ(run({"render", scene(), "--poison=never"}).code, 2);
  const Outcome text = run({"graph", scene(), "--layouts", "general", "--order-seed", "3"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("no placement needs less"), std::string::npos) << text.out;
}

TEST_F(CliTest, AccumulateIsTheMean) {
  const Words common = {"--aov", "gi_raw,depth,normal", "--precision", "float", "--accumulate"};
  const auto frames = [&](const char* name, Words words) {
    words.insert(words.end(), common.begin(), common.end());
    words.insert(words.end(), {"-o", out(name)});
    render(words);
    return image::read_exr(out(name));
  };
  const image::ExrFile one = frames("1.exr", {"--frames", "1"}), four = frames("4.exr", {"--frames", "4"});
  EXPECT_NE(layer(one, "gi_raw").image.pixels, layer(four, "gi_raw").image.pixels);
  EXPECT_LT(image::difference(layer(one, "depth").image, layer(four, "depth").image, 0).max_abs, 1e-5);

  // The four frames one by one, and their mean; without the jitter of antialiasing.
  render({"-o", out("f_{frame}.exr"), "--aov", "gi_raw", "--precision", "float", "--frames", "4", "--fps", "0", "--set",
          "taa.enabled=false"});
  image::Image mean = layer(image::read_exr(out("f_0.exr")), "gi_raw").image;
  for (const char* name : {"f_1.exr", "f_2.exr", "f_3.exr"}) {
    const image::ExrFile file = image::read_exr(out(name));
    for (size_t i = 0; i < mean.pixels.size(); ++i) mean.pixels[i] += layer(file, "gi_raw").image.pixels[i];
  }
  for (float& value : mean.pixels) value /= 4;
  EXPECT_LT(image::difference(mean, layer(four, "gi_raw").image, 0).max_abs, 1e-5);
}

TEST_F(CliTest, InfoIsJson) {
  const Outcome outcome = run({"info", "--techniques", "--params", "--devices", "--scene", scene(), "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const json doc = outcome.json();
  ASSERT_TRUE(doc.is_object()) << outcome.out;
  ASSERT_FALSE(doc["devices"].empty());
  for (const char* key : {"index", "name", "type", "usable"}) EXPECT_TRUE(doc["devices"][0].contains(key)) << key;
  std::set<std::string> techniques, params;
  for (const json& technique : doc["techniques"]) techniques.insert(technique["id"]);
  for (const json& param : doc["params"]) params.insert(param["id"]);
  for (const char* id : {"none", "hbao", "gtao", "vbao", "vbgi"}) EXPECT_TRUE(techniques.count(id)) << id;
  for (const char* id : {"gi.radius", "tonemap.exposure_ev"}) EXPECT_TRUE(params.count(id)) << id;
  EXPECT_GT(doc["scene"]["triangles"], 10);
  for (const Words& words :
       {Words{"info"}, {"info", "--params", "vbgi"}, {"info", "--scene", scene()}, {"info", "--devices"}}) {
    const Outcome text = run(words);
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_FALSE(text.out.empty());
  }
}

TEST_F(CliTest, GraphIsJsonOrText) {
  const json doc = run({"graph", scene(), "--size", "64x36", "--format", "json"}).json();
  ASSERT_TRUE(doc.is_object());
  EXPECT_EQ(doc["schema"], "nearfield.graph/1");
  EXPECT_TRUE(doc["histories"].is_array());
  for (const json& pass : doc["passes"]) {
    for (const char* key : {"name", "kind", "culled", "uses", "barriers"}) EXPECT_TRUE(pass.contains(key)) << key;
    for (const json& use : pass["uses"])
      for (const char* key : {"resource", "use", "slot", "mip"}) EXPECT_TRUE(use.contains(key)) << key;
  }
  for (const json& resource : doc["resources"])
    for (const char* key :
         {"name", "kind", "format", "size", "bytes", "first", "last", "heap", "offset", "transient", "alias_of"})
      EXPECT_TRUE(resource.contains(key)) << key;
  for (const char* key : {"placed_bytes", "max_live_bytes", "unaliased_bytes"})
    EXPECT_TRUE(doc["memory"].contains(key)) << key;
  const Outcome text = run({"graph", scene(), "--technique", "none"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("gbuffer.opaque"), std::string::npos);
  EXPECT_EQ(text.out.find("vbgi"), std::string::npos);
}

TEST_F(CliTest, HelpAndVersion) {
  for (const Words& words :
       {Words{"--help"}, {"render", "--help"}, {"graph", "--help"}, {"info", "--help"}, {"--version"}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_FALSE(outcome.out.empty());
  }
  EXPECT_TRUE(run({"--version"}).out.starts_with("nearfield "));
}

TEST_F(CliTest, InterruptWritesWhatThereIs) {
  const pid_t pid = start(
      {"render", scene(), "--size", "64x36", "-o", out("a.exr"), "--frames", "100000", "--accumulate", "--aov", "all"});
  ASSERT_TRUE(wait_for_handler(pid));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  kill(pid, SIGINT);
  const Outcome outcome = finish(pid);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const image::ExrFile file = image::read_exr(out("a.exr"));
  EXPECT_EQ(file.layers.size(), vbgi_layers.size());
  for (const image::Layer& l : file.layers) EXPECT_FALSE(image::find_non_finite(l.image).any()) << l.name;
  EXPECT_EQ(file.header.at("nearfield.complete"), "false");
}

// A second Ctrl-C does not wait for the frame.
TEST_F(CliTest, SecondInterruptEndsAtOnce) {
  const pid_t pid = start(
      {"render", scene(), "--size", "4096x4096", "-o", out("a.exr"), "--set", "gi.slices=64", "--set", "gi.steps=128"});
  ASSERT_TRUE(wait_for_handler(pid));
  kill(pid, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto start = std::chrono::steady_clock::now();
  kill(pid, SIGINT);
  EXPECT_EQ(finish(pid).code, 130);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace
}  // namespace nf
