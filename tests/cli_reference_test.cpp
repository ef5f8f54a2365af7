// `nearfield reference` as a process: layers, targets, interruption and resumption.
#include "cli_process.h"
#include "image/image.h"

namespace nf {
namespace {

class CliReferenceTest : public CliTest {
 protected:
  Outcome reference(const Words& words) const {
    Words all = {"reference", scene(), "--size", "48x27", "-o", out("r.exr")};
    all.insert(all.end(), words.begin(), words.end());
    return run(all);
  }
  void fails(int code, const Words& words, const std::string& mention) const {
    const Outcome o = reference(words);
    EXPECT_EQ(o.code, code) << o.err;
    EXPECT_NE(o.err.find(mention), std::string::npos) << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(written(), std::set<std::string>());
  }
};

TEST_F(CliReferenceTest, WritesLayersAndWhatMadeThem) {
  const Outcome o = reference(
      {"--spp", "8", "--aov", "gi,gi_1,depth,visibility", "--bounces", "2", "--json", "-", "--radius", "0.5"});
  ASSERT_EQ(o.code, 0) << o.err;
  const image::ExrFile file = image::read_exr(out("r.exr"));
  std::map<std::string, std::string> layers;
  for (const image::Layer& l : file.layers) {
    layers[l.name] = l.channels;
    EXPECT_EQ(l.image.width, 48u);
    EXPECT_EQ(l.image.height, 27u);
    EXPECT_FALSE(image::find_non_finite(l.image).any()) << l.name;
  }
  EXPECT_EQ(layers, (std::map<std::string, std::string>{
                        {"", "RGB"}, {"gi", "RGB"}, {"gi_1", "RGB"}, {"depth", "V"}, {"visibility", "V"}}));
  EXPECT_EQ(file.header.at("nearfield.spp"), "8");
  EXPECT_EQ(file.header.at("nearfield.seed"), "1");
  EXPECT_EQ(file.header.at("nearfield.complete"), "true");
  EXPECT_EQ(file.header.at("nearfield.radius"), "0.5 ball");
  EXPECT_NE(file.header.at("nearfield.noise_rmse").find("gi_1="), std::string::npos);
  EXPECT_NE(file.header.at("nearfield.device").find("Embree"), std::string::npos);
  const nlohmann::json d = o.json();
  EXPECT_EQ(d["schema"], "nearfield.reference/1");
  EXPECT_EQ(d["spp"], 8);
  EXPECT_EQ(d["complete"], true);
  EXPECT_EQ(written(), std::set<std::string>{"r.exr"});
}

// One triangle with a material of its own, and in two variants another.
std::string triangle_with_variants() {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
  "extensionsUsed": ["KHR_materials_variants"],
  "extensions": {"KHR_materials_variants": {"variants": [{"name": "Night"}, {"name": "Day trip"}]}},
  "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 1]}},
                {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0, 0, 1]}}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0, "extensions": {"KHR_materials_variants":
    {"mappings": [{"material": 1, "variants": [1]}]}}}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}]})";
}

TEST_F(CliReferenceTest, VariantsAreChosenByName) {
  const std::string file = input("variants.gltf", triangle_with_variants());
  const auto red = [&](const Words& words) {
    Words all = {"reference", file, "--size", "9x9", "--spp", "2", "--aov", "albedo", "-o", out("r.exr")};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome o = run(all);
    EXPECT_EQ(o.code, 0) << o.err;
    for (const image::Layer& l : image::read_exr(out("r.exr")).layers)
      if (l.name == "albedo") return l.image.at(4, 4, 0);
    return -1.0f;
  };
  EXPECT_NEAR(red({}), 0.25f, 1e-5f);
  EXPECT_NEAR(red({"--variant", "Night"}), 0.25f, 1e-5f) << "nothing changes in this one";
  EXPECT_NEAR(red({"--variant", "Day trip"}), 0.5f, 1e-5f);
  const Outcome info = run({"info", "--scene", file, "--json"});
  EXPECT_EQ(info.json()["scene"]["variants"], nlohmann::json({"Night", "Day trip"})) << info.err;
  std::filesystem::remove(out("r.exr"));
  const Outcome unknown = run({"reference", file, "-o", out("r.exr"), "--variant", "day trip"});
  EXPECT_EQ(unknown.code, 3);
  EXPECT_NE(unknown.err.find("no variant 'day trip'"), std::string::npos) << unknown.err;
  EXPECT_NE(unknown.err.find("'Night', 'Day trip'"), std::string::npos) << unknown.err;
  fails(3, {"--variant", "Night"}, "has none; leave --variant away");
}

TEST_F(CliReferenceTest, TheSameCommandGivesTheSameBytes) {
  EXPECT_EQ(reference({"--spp", "4", "--threads", "1"}).code, 0);
  const image::ExrFile one = image::read_exr(out("r.exr"));
  EXPECT_EQ(reference({"--spp", "4", "--threads", "3"}).code, 0);
  const image::ExrFile three = image::read_exr(out("r.exr"));
  ASSERT_EQ(one.layers.size(), three.layers.size());
  for (size_t i = 0; i < one.layers.size(); ++i) EXPECT_EQ(one.layers[i].image.pixels, three.layers[i].image.pixels);
  const std::string bytes = bytes_of(out("r.exr"));
  EXPECT_EQ(reference({"--spp", "4", "--threads", "3"}).code, 0);
  EXPECT_EQ(bytes_of(out("r.exr")), bytes);
}

TEST_F(CliReferenceTest, StopsAtAnErrorOrATime) {
  const Outcome error = reference({"--aov", "visibility,gi", "--until-error", "0.1", "--json", "-"});
  EXPECT_EQ(error.code, 0) << error.err;
  const nlohmann::json document = error.json();
  ASSERT_FALSE(document["noise"].empty());
  for (const nlohmann::json& n : document["noise"]) EXPECT_LE(n["relative"].get<double>(), 0.1);
  EXPECT_LT(error.json()["spp"].get<int>(), 100000);
  const Outcome time = reference({"--seconds", "0.1", "--json", "-"});
  EXPECT_EQ(time.code, 0) << time.err;
  EXPECT_GE(time.json()["seconds"].get<double>(), 0.1);
  EXPECT_GT(time.json()["spp"].get<int>(), 0);
}

TEST_F(CliReferenceTest, TheHalvesTellTheNoise) {
  const Outcome o = reference({"--spp", "16", "--aov", "visibility", "--halves", "--json", "-"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(written(), (std::set<std::string>{"r.exr", "r.a.exr", "r.b.exr"}));
  const Outcome between =
      run({"compare", out("r.a.exr"), out("r.b.exr"), "--layer", "visibility", "--metric", "rmse", "--json", "-"});
  const nlohmann::json document = o.json();
  for (const nlohmann::json& n : document["noise"]) {
    if (n["layer"] != "visibility") continue;
    EXPECT_NEAR(between.json()["metrics"]["rmse"]["value"].get<double>() / 2, n["rmse"].get<double>(), 1e-6);
  }
}

// Ctrl-C keeps what is there; --resume goes on to the same bytes as if never interrupted.
TEST_F(CliReferenceTest, InterruptAndResume) {
  const Words words = {"reference", scene(), "--size", "48x27", "-o", out("r.exr"), "--aov", "gi"};
  Words endless = words;
  endless.insert(endless.end(), {"--spp", "1000000", "--progress", "none"});
  const pid_t pid = start(endless);
  ASSERT_TRUE(wait_for_handler(pid));
  kill(pid, SIGINT);
  const Outcome o = finish(pid);
  EXPECT_EQ(o.code, 130) << o.err;
  EXPECT_EQ(written(), (std::set<std::string>{"r.exr", "r.exr.checkpoint"}));
  const image::ExrFile partial = image::read_exr(out("r.exr"));
  EXPECT_EQ(partial.header.at("nearfield.complete"), "false");
  const int done = std::stoi(partial.header.at("nearfield.spp"));
  EXPECT_GT(done, 0);

  Words more = words;
  more.insert(more.end(), {"--spp", std::to_string(done + 10), "--resume"});
  EXPECT_EQ(run(more).code, 0);
  const image::ExrFile resumed = image::read_exr(out("r.exr"));
  EXPECT_EQ(resumed.header.at("nearfield.spp"), std::to_string(done + 10));
  Words other = more;
  other.insert(other.end(), {"--seed", "9"});
  EXPECT_EQ(run(other).code, 3);

  Words whole = words;
  whole.insert(whole.end(), {"--spp", std::to_string(done + 10)});
  EXPECT_EQ(run(whole).code, 0);
  EXPECT_EQ(image::read_exr(out("r.exr")).layers[1].image.pixels, resumed.layers[1].image.pixels);
  EXPECT_EQ(written(), std::set<std::string>{"r.exr"});  // done: the checkpoint has had its use
}

TEST_F(CliReferenceTest, SettingsReachTheTracer) {
  const auto layer = [&](const Words& words, const std::string& name) {
    EXPECT_EQ(reference(words).code, 0);
    for (const image::Layer& l : image::read_exr(out("r.exr")).layers)
      if (l.name == name) return l.image.pixels;
    return std::vector<float>();
  };
  const auto open = layer({"--spp", "8", "--aov", "visibility", "--radius", "0.2"}, "visibility");
  EXPECT_NE(open, layer({"--spp", "8", "--aov", "visibility"}, "visibility"));
  EXPECT_NE(open,
            layer({"--spp", "8", "--aov", "visibility", "--radius", "0.2", "--radius-mode", "disc"}, "visibility"));
  EXPECT_NE(open, layer({"--spp", "8", "--aov", "visibility", "--radius", "0.2", "--seed", "2"}, "visibility"));
  EXPECT_NE(layer({"--spp", "8", "--aov", "indirect"}, "indirect"),
            layer({"--spp", "8", "--aov", "indirect", "--set", "material.lambert=true"}, "indirect"));
}

// Marched through buffers that it traces itself, or that a file gives: the same ones, the same light.
TEST_F(CliReferenceTest, SameInformation) {
  const auto layers = [&](const Words& words) {
    const Outcome o = reference(words);
    EXPECT_EQ(o.code, 0) << o.err;
    std::map<std::string, std::vector<float>> pixels;
    for (const image::Layer& l : image::read_exr(out("r.exr")).layers) pixels[l.name] = l.image.pixels;
    return pixels;
  };
  const auto own = layers({"--same-information", "--spp", "8"});
  for (const char* name : {"gi", "visibility", "bent", "depth", "normal", "radiance"})
    EXPECT_TRUE(own.count(name)) << name;
  EXPECT_EQ(image::read_exr(out("r.exr")).header.at("nearfield.radius"), "4 disc");
  const std::string buffers = (base_ / "in/buffers.exr").string();
  std::filesystem::copy(out("r.exr"), buffers);
  EXPECT_EQ(layers({"--same-information", "--spp", "8", "--buffers", buffers}), own);
  EXPECT_NE(layers({"--same-information", "--spp", "8", "--set", "gi.thickness=1"}).at("visibility"),
            own.at("visibility"));
  EXPECT_NE(layers({"--same-information", "--spp", "8", "--set", "gi.radius=0.1"}).at("gi"), own.at("gi"));
  EXPECT_NE(layers({"--same-information", "--spp", "8", "--directions", "uniform"}).at("gi"), own.at("gi"));
}

TEST_F(CliReferenceTest, Failures) {
  fails(2, {"--same-information", "--resume"}, "--resume");
  fails(2, {"--buffers", "b.exr"}, "--same-information");
  fails(2, {"--gpu"}, "--same-information");
  fails(3, {"--same-information", "--buffers", "/no/such.exr"}, "/no/such.exr");
  fails(2, {"--spp", "0"}, "--spp");
  fails(2, {"--radius", "wide"}, "--radius");
  fails(2, {"--radius", "-1"}, "--radius");
  fails(2, {"--bounces", "99"}, "--bounces");
  fails(2, {"--until-error", "0"}, "--until-error");
  fails(2, {"--size", "0x4"}, "size");
  fails(3, {"--aov", "shine"}, "shine");
  fails(3, {"--aov", "gi_7"}, "--bounces");
  fails(3, {"--view", "nosuch"}, "nosuch");
  fails(3, {"--set", "material.lambart=true"}, "material.lambert");
  const Outcome o = run({"reference", scene(), "-o", out("r.png")});
  EXPECT_EQ(o.code, 2);
  EXPECT_NE(o.err.find(".exr"), std::string::npos);
  EXPECT_EQ(run({"reference", scene(), "-o", out("no/r.exr")}).code, 7);
  EXPECT_EQ(run({"reference", "/no/such.glb", "-o", out("r.exr")}).code, 3);
}

}  // namespace
}  // namespace nf
