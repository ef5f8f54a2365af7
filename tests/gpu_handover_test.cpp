// Two users of one VkDevice, each in a thread of its own: what one hands over is what the other sees, and stays so
// while the next ones are made. Under validation; and that validation notices when the hand-over lacks its barrier.
#include <fstream>
#include <thread>

#include "core/log.h"
#include "gpu/upload.h"
#include "gpu_fixture.h"
#include "live/handover.h"

namespace nf::test {
namespace {

#define NF_FILL_FIELDS(F) F(Float, grey)
NF_DECLARE_BLOCK(FillBlock, "fill", NF_FILL_FIELDS)

constexpr const char* fill_text = R"(#version 460
#include "params/fill"
layout(location = 0) out vec4 color;
void main() { color = vec4(fill.grey); }
)";
constexpr const char* see_text = R"(#version 460
uniform texture2D shown;
layout(location = 0) out vec4 color;
void main() { color = texelFetch(shown, ivec2(gl_FragCoord.xy), 0); }
)";

// A user's own pipelines and executor.
struct User {
  User(gpu::Device& device, const std::filesystem::path& shaders, const std::string& file)
      : pipelines(device, compiler(shaders), {}), pass(pipelines.fullscreen(file)), executor(device, pipelines) {}
  static gpu::ShaderCompiler compiler(const std::filesystem::path& shaders) {
    gpu::ShaderCompiler made(shaders, {});
    made.add_table(FillBlock::table());
    return made;
  }
  gpu::Pipelines pipelines;
  gpu::Pipeline pass;
  graph::Executor executor;
};

class HandoverTest : public GpuTest {
 protected:
  void SetUp() override {
    shaders_ = temporary("shaders");
    std::filesystem::create_directories(shaders_);
    std::filesystem::create_directory_symlink(std::filesystem::path(NF_SOURCE_DIR) / "shaders" / "common",
                                              shaders_ / "common");
    std::ofstream(shaders_ / "fill.frag") << fill_text;
    std::ofstream(shaders_ / "see.frag") << see_text;
  }
  void TearDown() override {
    if (handover_) handover_.reset();
    for (const std::string& message : shared_.take_messages()) ADD_FAILURE() << message;
    GpuTest::TearDown();
  }
  // The renderer's frame number `n`, of a grey that tells it.
  const gpu::LentImage& write(User& renderer, uint32_t n, glm::uvec2 size, const graph::ExecuteOptions& options = {}) {
    const gpu::LentImage& lent = handover_->write(size);
    graph::Graph graph;
    const graph::Tex picture = graph.image("picture", {{size.x, size.y}, VK_FORMAT_R8G8B8A8_UNORM});
    graph.fullscreen("fill", renderer.pass).out("color", picture).params(FillBlock{.grey = float(n % 256) / 255});
    graph.hand_over("hand_over", picture, lent.image);
    graph::ExecuteOptions all = options;
    all.then = lent.written;
    renderer.executor.run(graph, all);
    renderer.executor.finish();
    return lent;
  }
  // What the window sees: the number in all texels, or -1.
  static int see(User& window, const gpu::LentImage& lent) {
    const VkExtent2D& extent = lent.image.info.extent;
    graph::Graph graph;
    const graph::Tex seen = graph.image("seen", {{extent.width, extent.height}, VK_FORMAT_R8G8B8A8_UNORM});
    graph.fullscreen("see", window.pass).in("shown", graph.import("shown", lent.image)).out("color", seen);
    graph.readback("readback.seen", seen);
    window.executor.run(graph, {.after = lent.written});
    const std::vector<std::byte> texels = window.executor.take_readbacks().at(0).texels;
    for (const std::byte texel : texels)
      if (texel != texels[0]) return -1;
    return int(texels[0]);
  }
  std::filesystem::path shaders_;
  gpu::Device shared_{gpu::DeviceOptions{.validation = true, .second_queue = true}};
  std::unique_ptr<editor::live::Handover> handover_ = std::make_unique<editor::live::Handover>(shared_);
};

TEST_F(HandoverTest, WhatIsShownStaysWhileTheNextIsWritten) {
  std::printf("%u queues\n", shared_.queues);
  std::mutex mailbox;
  const gpu::LentImage* newest = nullptr;
  uint32_t number = 0, last = 0;
  std::atomic<bool> stop = false;
  std::thread renderer([&] {
    gpu::Device device(gpu::SecondUser{shared_});
    User user(device, shaders_, "fill.frag");
    for (uint32_t n = 1; !stop; ++n) {
      const gpu::LentImage& lent = write(user, n, n % 7 < 5 ? glm::uvec2(48, 32) : glm::uvec2(31, 17));
      const std::lock_guard lock(mailbox);
      handover_->publish();
      newest = &lent;
      number = n;
    }
  });
  {
    User window(shared_, shaders_, "see.frag");
    for (uint32_t taken = 0; taken < 40;) {
      const gpu::LentImage* lent = nullptr;
      {
        const std::lock_guard lock(mailbox);
        if ((lent = std::exchange(newest, nullptr))) handover_->take(), last = number, ++taken;
      }
      if (!lent) {
        std::this_thread::yield();
        continue;
      }
      // The renderer goes on meanwhile.
      for (int again = 0; again < 3; ++again) EXPECT_EQ(see(window, *lent), int(last % 256));
      EXPECT_EQ(int(gpu::download_image(shared_, *lent)[0]), int(last % 256));
    }
    stop = true;
    renderer.join();
  }
  EXPECT_GE(last, 40u);
}

TEST_F(HandoverTest, ValidationNoticesALackingBarrier) {
  gpu::Device device(gpu::SecondUser{shared_});
  User renderer(device, shaders_, "fill.frag"), window(shared_, shaders_, "see.frag");
  EXPECT_EQ(see(window, write(renderer, 7, {8, 8})), 7);
  EXPECT_TRUE(shared_.take_messages().empty());
  spdlog::set_level(spdlog::level::off);  // the report is wanted here, not shown
  see(window, write(renderer, 8, {8, 8}, {.drop_hand_over = true}));
  spdlog::set_level(spdlog::level::info);
  EXPECT_FALSE(shared_.take_messages().empty());
}

TEST_F(HandoverTest, ALostDeviceIsLostForBoth) {
  gpu::Device device(gpu::SecondUser{shared_});
  User renderer(device, shaders_, "fill.frag"), window(shared_, shaders_, "see.frag");
  const gpu::LentImage& lent = write(renderer, 1, {8, 8});
  device.pretend_lost();
  EXPECT_THROW(write(renderer, 2, {8, 8}), Error);
  EXPECT_THROW(see(window, lent), Error);
  EXPECT_THROW(gpu::download_image(shared_, lent), Error);
}

}  // namespace
}  // namespace nf::test
