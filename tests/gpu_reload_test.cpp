// Shaders edited while frames run: what is broken leaves the last good program running, what is mended shows.
#include "gpu_fixture.h"

namespace nf::test {
namespace {

using Names = std::vector<std::string>;

class Reload : public EditedShadersTest {
 protected:
  void SetUp() override {
    EditedShadersTest::SetUp();
    scene_ = load(small_room());
    renderer_ = std::make_unique<passes::Renderer>(device(), scene_);
  }
  void TearDown() override {
    renderer_.reset();
    EditedShadersTest::TearDown();
  }
  gpu::Reload reload(const Names& changed) { return renderer_->pipelines().reload(changed); }
  std::vector<std::byte> frame() {
    passes::FrameView view;
    view.camera = view.previous_camera = inside_small_room();
    view.size = {64, 36};
    view.averaged = false;
    graph::Graph graph(renderer_->executor().histories());
    const passes::FrameOutputs out = renderer_->build(graph, view, settings_);
    graph.readback("picture", renderer_->add_picture(graph, out, settings_));
    renderer_->executor().run(graph);
    return renderer_->executor().take_readbacks().at(0).texels;
  }
  scene::Scene scene_;
  passes::FrameSettings settings_;
  std::unique_ptr<passes::Renderer> renderer_;
};

TEST_F(Reload, ABrokenShaderKeepsThePictureAndAMendedOneChangesIt) {
  const std::string good = text_of("tonemap.frag");
  const std::vector<std::byte> before = frame();
  EXPECT_EQ(frame(), before);
  const uint64_t replans = renderer_->executor().replans();

  write("tonemap.frag", good + "\nvoid broken() { no_such_word = 1.0; }\n");
  const gpu::Reload broken = reload({"tonemap.frag"});
  EXPECT_EQ(broken.recompiled, 0u);
  ASSERT_EQ(broken.errors.size(), 1u);
  EXPECT_EQ(broken.errors[0].file, "tonemap.frag");
  EXPECT_EQ(broken.errors[0].line, uint32_t(std::count(good.begin(), good.end(), '\n')) + 2);
  EXPECT_EQ(broken.errors[0].column, 17u);
  EXPECT_EQ(broken.errors[0].source_line, "void broken() { no_such_word = 1.0; }");
  EXPECT_NE(broken.errors[0].message.find("no_such_word"), std::string::npos);
  EXPECT_EQ(frame(), before);

  // Whatever else changes, the broken one is tried again, and still says what is wrong.
  EXPECT_EQ(reload({"marcher.comp"}).errors, broken.errors);

  // Its two slots are no longer used: the frame still feeds them.
  write("tonemap.frag",
        "#version 460\nlayout(location = 0) out vec4 ldr;\nvoid main() { ldr = vec4(1.0, 0.5, 0.0, 1.0); }\n");
  const gpu::Reload mended = reload({"tonemap.frag"});
  EXPECT_TRUE(mended.errors.empty());
  EXPECT_EQ(mended.recompiled, 1u);
  EXPECT_GT(mended.ms, 0);
  const std::vector<std::byte> orange = frame();
  EXPECT_NE(orange, before);
  ASSERT_EQ(orange.size(), 64u * 36 * 4);
  for (size_t i = 0; i < orange.size(); i += 4)
    ASSERT_TRUE(uint8_t(orange[i]) == 255 && uint8_t(orange[i + 2]) == 0) << "texel " << i / 4;

  write("tonemap.frag", good);
  EXPECT_EQ(reload({"tonemap.frag"}).recompiled, 1u);
  EXPECT_EQ(frame(), before);
  EXPECT_EQ(renderer_->executor().replans(), replans + 2) << "one for the slots that went, one for their return";
}

// A common file reaches the programs that read it and no others, all or nothing each.
TEST_F(Reload, AnIncludeReachesWhoReadsIt) {
  const std::vector<std::byte> before = frame();
  const uint32_t all = reload({}).recompiled;
  const uint32_t none = reload({"report.html"}).recompiled, some = reload({"common/brdf.glsl"}).recompiled;
  std::printf("%u programs, %u of them read common/brdf.glsl\n", all, some);
  EXPECT_EQ(none, 0u);
  EXPECT_GT(some, 0u);
  EXPECT_LT(some, all);
  EXPECT_EQ(frame(), before);

  gpu::ShaderWatch watch(shaders_, std::chrono::milliseconds(0));
  const std::string good = text_of("common/brdf.glsl");
  write("common/brdf.glsl", "float twice(float x) { return x * 2.0 }\n" + good);
  const gpu::Reload broken = reload({"common/brdf.glsl"});
  EXPECT_EQ(broken.recompiled, 0u);
  ASSERT_EQ(broken.errors.size(), 1u) << "one fault, however many programs have it";
  EXPECT_EQ(broken.errors[0].file, "common/brdf.glsl");
  EXPECT_EQ(broken.errors[0].line, 1u);
  EXPECT_EQ(frame(), before);
  write("common/brdf.glsl", good);
  const Names changed = watch.changed();
  EXPECT_EQ(changed, Names{"common/brdf.glsl"}) << "written twice, told once";
  const gpu::Reload mended = reload(changed);
  EXPECT_EQ(mended.recompiled, some);
  EXPECT_TRUE(mended.errors.empty());
  EXPECT_EQ(frame(), before);

  // A new include, broken at first: the program that asks for it waits for it.
  edit("tonemap.frag", "void main() {", "#include \"common/fresh.glsl\"\nvoid main() {");
  EXPECT_EQ(reload({"tonemap.frag"}).errors.size(), 1u);
  write("common/fresh.glsl", "const float fresh = 1.0;\n");
  EXPECT_EQ(reload({"common/fresh.glsl"}).recompiled, 1u);
  EXPECT_EQ(reload({"common/fresh.glsl"}).recompiled, 1u) << "and depends on it from then on";
  EXPECT_EQ(frame(), before);
}

// Kept shadow maps were drawn by the old program.
TEST_F(Reload, KeptMapsAreDrawnAnew) {
  const std::vector<std::byte> before = frame();
  EXPECT_EQ(frame(), before);
  const std::string good = text_of("shadow.vert");
  const std::string place = "gl_Position = shadow_view.clip_from_world * vec4(world, 1.0);";
  edit("shadow.vert", place, place + " gl_Position.x += gl_Position.w;");
  EXPECT_GT(reload({"shadow.vert"}).recompiled, 0u);
  EXPECT_NE(frame(), before);
  write("shadow.vert", good);
  reload({"shadow.vert"});
  EXPECT_EQ(frame(), before);
  EXPECT_EQ(frame(), before);
}

// The interface changes in place. A slot that goes is no fault; one that nobody feeds is, and the frame says so instead
// of running a plan that does not know of it.
TEST_F(Reload, PlansFollowTheInterface) {
  const std::vector<std::byte> before = frame();
  const std::string good = text_of("composite.frag");
  edit("composite.frag", "void main() {", "uniform texture2D stranger;\nvoid main() {");
  std::string text = text_of("composite.frag");
  text.insert(text.rfind('}'), "  lit += texelFetch(stranger, ivec2(0), 0);\n");
  write("composite.frag", text);
  EXPECT_TRUE(reload({"composite.frag"}).errors.empty()) << "it compiles";
  for (int i = 0; i < 2; ++i) try {
      frame();
      ADD_FAILURE() << "the frame ran with a slot that nobody feeds";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("'stranger' is not fed"), std::string::npos) << error.what();
    }
  write("composite.frag", good);
  reload({"composite.frag"});
  EXPECT_EQ(frame(), before);

  // Another shape of workgroup: the number of groups follows.
  const uint64_t replans = renderer_->executor().replans();
  const std::string main = text_of("gi/inputs.glsl");
  const size_t at = main.find("local_size_x");
  ASSERT_NE(at, main.npos);
  const size_t end = main.find(")", at);
  write("gi/inputs.glsl", main.substr(0, at) + "local_size_x = 32, local_size_y = 4" + main.substr(end));
  EXPECT_EQ(reload({"gi/inputs.glsl"}).recompiled, 1u);
  EXPECT_EQ(frame(), before);
  EXPECT_EQ(renderer_->executor().replans(), replans + 1);
}

// What compiles and could not run: told before the driver meets it.
TEST_F(Reload, LimitsAreFaultsToo) {
  const std::vector<std::byte> before = frame();
  const std::string tonemap = text_of("tonemap.frag"), vertex = text_of("gbuffer.vert");
  const size_t end = tonemap.rfind('}');
  const auto fault = [&](const char* file, const std::string& text) {
    write(file, text);
    const gpu::Reload result = reload({file});
    EXPECT_EQ(frame(), before);
    return result.errors.empty() ? std::string() : result.errors[0].file + ": " + result.errors[0].message;
  };
  EXPECT_NE(fault("tonemap.frag",
                  tonemap.substr(0, end) + "  ldr += texture(sampler2D(lit, my_sampler), vec2(0.5)) * 0.0;\n}\n")
                .find("my_sampler"),
            std::string::npos);
  std::string with_sampler = tonemap;
  with_sampler.insert(tonemap.find("void main"), "uniform sampler my_sampler;\n");
  EXPECT_NE(fault("tonemap.frag", with_sampler.substr(0, with_sampler.rfind('}')) +
                                      "  ldr += texture(sampler2D(lit, my_sampler), vec2(0.5)) * 0.0;\n}\n")
                .find("no sampler is named 'my_sampler'"),
            std::string::npos);
  EXPECT_EQ(fault("tonemap.frag", tonemap), "");
  std::string with_input = vertex;
  with_input.insert(vertex.find("void main"), "layout(location = 9) in vec4 stranger;\n");
  with_input.insert(with_input.rfind('}'), "  gl_Position += stranger * 0.0;\n");
  EXPECT_NE(fault("gbuffer.vert", with_input).find("gbuffer.vert: reads the vertex input of location 9"),
            std::string::npos);
  EXPECT_EQ(fault("gbuffer.vert", vertex), "");

  // Outputs: one that is gone, one more, another name. The frame has attachments for those it was written with.
  const std::string declared = "layout(location = 0) out vec4 ldr;";
  ASSERT_NE(tonemap.find(declared), tonemap.npos);
  const auto edited = [&](const std::string& to) {
    std::string text = tonemap;
    return text.replace(text.find(declared), declared.size(), to);
  };
  EXPECT_NE(fault("tonemap.frag", edited("vec4 ldr;")).find("tonemap.frag: its outputs were ldr, and are none"),
            std::string::npos);
  std::string more = edited(declared + "\nlayout(location = 1) out vec4 more;");
  more.insert(more.rfind('}'), "  more = ldr;\n");
  EXPECT_NE(fault("tonemap.frag", more).find("are ldr, more"), std::string::npos);
  EXPECT_NE(fault("tonemap.frag", edited("layout(location = 0) out vec4 other;\n#define ldr other")).find("are other"),
            std::string::npos);
  EXPECT_EQ(fault("tonemap.frag", tonemap), "");
}

}  // namespace
}  // namespace nf::test
