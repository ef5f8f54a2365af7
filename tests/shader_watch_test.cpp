// Shaders being edited, without a device: which files changed, and where a compiler's words point to.
#include <fstream>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>

#include "gpu/reload.h"
#include "gpu/shader.h"

namespace nf::gpu {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Names = std::vector<std::string>;

#define NF_PAINT_PARAMS(P) P(Float, amount, 1, 0, 2, "", "How much")
NF_DECLARE_PARAMS(PaintParams, "paint", NF_PAINT_PARAMS)

class Shaders : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() /
        fmt::format("nearfield-watch-{}-{}", testing::UnitTest::GetInstance()->current_test_info()->name(), getpid());
    fs::create_directories(folder_ / "common");
  }
  void TearDown() override { fs::remove_all(folder_); }
  // `age`: how long ago, by the file's own time.
  void write(const std::string& name, const std::string& text, std::chrono::seconds age = 60s) const {
    std::ofstream(folder_ / name) << text;
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - age);
  }
  fs::path folder_;
};

TEST_F(Shaders, ChangesAreToldOnce) {
  write("a.frag", "1");
  write("common/b.glsl", "1");
  write("notes.txt", "1");
  ShaderWatch watch(folder_);
  EXPECT_EQ(watch.changed(), Names{});
  write("common/b.glsl", "22", 50s);
  write("notes.txt", "22", 50s);
  write(".a.frag", "a lock", 50s);
  write("a.frag~", "a copy", 50s);
  EXPECT_EQ(watch.changed(), Names{"common/b.glsl"});
  EXPECT_EQ(watch.changed(), Names{});
  write("new.comp", "1", 50s);
  write("a.frag", "2", 50s);  // same size, another time
  EXPECT_EQ(watch.changed(), (Names{"a.frag", "new.comp"}));
  EXPECT_EQ(watch.changed(), Names{});
}

TEST_F(Shaders, AFileRenamedOverAnotherIsAChange) {
  write("a.frag", "1");
  const fs::file_time_type time = fs::last_write_time(folder_ / "a.frag");
  ShaderWatch watch(folder_);
  // Same name, size and time: only the file is another.
  write("aside.tmp", "2");
  fs::last_write_time(folder_ / "aside.tmp", time);
  fs::rename(folder_ / "aside.tmp", folder_ / "a.frag");
  EXPECT_EQ(watch.changed(), Names{"a.frag"});
  EXPECT_EQ(watch.changed(), Names{});
}

TEST_F(Shaders, AFileBeingWrittenWaits) {
  write("a.frag", "1");
  ShaderWatch patient(folder_, 1h), quick(folder_, 20ms);
  // A file time ahead of the clock: only the watch's own clock can tell that it is quiet.
  write("a.frag", "half", -1000s);
  EXPECT_EQ(patient.changed(), Names{});
  EXPECT_EQ(quick.changed(), Names{});
  std::this_thread::sleep_for(40ms);
  EXPECT_EQ(patient.changed(), Names{});
  EXPECT_EQ(quick.changed(), Names{"a.frag"});
  // Written again meanwhile: the wait begins anew. Put back as it was told: nothing to tell.
  write("a.frag", "whole", -1000s);
  EXPECT_EQ(quick.changed(), Names{});
  std::this_thread::sleep_for(40ms);
  write("a.frag", "whole, and more", -1000s);
  EXPECT_EQ(quick.changed(), Names{});
  std::this_thread::sleep_for(40ms);
  EXPECT_EQ(quick.changed(), Names{"a.frag"});
}

TEST_F(Shaders, AFileThatIsGoneIsAChangeUnlessItComesBack) {
  write("a.frag", "1");
  ShaderWatch watch(folder_, 20ms);
  fs::rename(folder_ / "a.frag", folder_ / "aside");
  EXPECT_EQ(watch.changed(), Names{});
  fs::rename(folder_ / "aside", folder_ / "a.frag");
  EXPECT_EQ(watch.changed(), Names{});
  std::this_thread::sleep_for(40ms);
  EXPECT_EQ(watch.changed(), Names{});
  fs::remove(folder_ / "a.frag");
  EXPECT_EQ(watch.changed(), Names{});
  std::this_thread::sleep_for(40ms);
  EXPECT_EQ(watch.changed(), Names{"a.frag"});
  EXPECT_EQ(watch.changed(), Names{});
  write("a.frag", "1");
  EXPECT_EQ(watch.changed(), Names{"a.frag"});
  fs::remove_all(folder_);
  std::this_thread::sleep_for(40ms);
  EXPECT_NO_THROW(watch.changed());
}

// What compile() throws for these files, as faults.
std::vector<ReloadError> faults(const fs::path& folder, const std::string& file) {
  ShaderCompiler compiler(folder, {});
  compiler.add_table(PaintParams::table());
  try {
    compiler.compile({file}, {});
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::Shader);
    return shader_errors(compiler, error.what());
  }
  return {};
}

constexpr const char* head = "#version 460\nlayout(location = 0) out vec4 colour;\n";

TEST_F(Shaders, FaultsAreWhereTheyWereWritten) {
  write("common/inner.glsl", "// one\nfloat inner() {\n  return missing_word + 1.0;\n}\n");
  write("common/outer.glsl", "#include \"common/inner.glsl\"\nfloat outer() { return inner(); }\n");
  write("a.frag", std::string(head) + "#include \"common/outer.glsl\"\nvoid main() { colour = vec4(outer()); }\n");
  const auto inner = faults(folder_, "a.frag");
  ASSERT_FALSE(inner.empty());
  EXPECT_EQ(inner[0].file, "common/inner.glsl");
  EXPECT_EQ(inner[0].line, 3u);
  EXPECT_EQ(inner[0].column, 10u);
  EXPECT_EQ(inner[0].source_line, "  return missing_word + 1.0;");
  EXPECT_NE(inner[0].message.find("undeclared"), std::string::npos) << inner[0].message;

  // Behind an include, the lines are the file's own again.
  write("common/inner.glsl", "float inner() {\n\n\n  return 1.0;\n}\n");
  write("a.frag", std::string(head) + "#include \"common/outer.glsl\"\n\nvoid main() { colour = vec3(outer()); }\n");
  const auto own = faults(folder_, "a.frag");
  ASSERT_FALSE(own.empty());
  EXPECT_EQ(own[0].file, "a.frag");
  EXPECT_EQ(own[0].line, 5u);
  EXPECT_EQ(own[0].source_line, "void main() { colour = vec3(outer()); }");

  write("common/outer.glsl", "\n#include \"common/nowhere.glsl\"\n");
  const auto lost = faults(folder_, "a.frag");
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].file, "common/outer.glsl");
  EXPECT_EQ(lost[0].line, 2u);
  EXPECT_NE(lost[0].message.find("common/nowhere.glsl"), std::string::npos);
  EXPECT_EQ(lost[0].source_line, "#include \"common/nowhere.glsl\"");

  write("a.frag", std::string(head) + "#include \"params/paint\"\nvoid main() { colour = vec4(paint.colour); }\n");
  const auto member = faults(folder_, "a.frag");
  ASSERT_FALSE(member.empty());
  EXPECT_EQ(member[0].file, "a.frag");
  EXPECT_EQ(member[0].line, 4u);

  write("a.frag", std::string(head) + "#include \"params/paint\"\nvoid main() { colour = vec4(paint.amount); }\n");
  EXPECT_TRUE(faults(folder_, "a.frag").empty());
}

TEST_F(Shaders, FaultsWithoutALine) {
  write("a.frag", std::string(head) + "void paint();\nvoid main() { paint(); colour = vec4(1); }\n");
  const auto unlinked = faults(folder_, "a.frag");
  ASSERT_FALSE(unlinked.empty());
  EXPECT_EQ(unlinked[0].file, "a.frag");
  EXPECT_EQ(unlinked[0].line, 0u);
  EXPECT_FALSE(unlinked[0].message.empty());
  const auto gone = faults(folder_, "b.frag");
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_EQ(gone[0].line, 0u);
  EXPECT_NE(gone[0].message.find("b.frag"), std::string::npos);
}

}  // namespace
}  // namespace nf::gpu
