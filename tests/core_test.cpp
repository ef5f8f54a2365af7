// Parameter tables, errors and the check macro.
#include <cstddef>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/params.h"

namespace nf {
namespace {

using nlohmann::json;

// One parameter of each editable type; 0.1f is not what 0.1 is, so defaults must be compared as they are stored.
#define NF_BLUR_PARAMS(P)                                            \
  P(Float, radius, 0.1f, 0.0f, 16.0f, "px", "Radius of the blur")    \
  P(Int, taps, 5, -3, 33, "", "Samples")                             \
  P(Bool, edge_aware, true, 0, 1, "", "Stop at edges")               \
  P(Choice, shape, 1, 0, 2, "box|gauss|tent", "Shape of the kernel") \
  P(Float, sigma, 2.5f, 0.5f, 8.0f, "px", "Standard deviation")
NF_DECLARE_PARAMS(BlurParams, "blur", NF_BLUR_PARAMS)

#define NF_GLOW_PARAMS(P) P(Float, gain, 1.0f, 0.0f, 4.0f, "", "Strength")
NF_DECLARE_PARAMS(GlowParams, "glow", NF_GLOW_PARAMS)

#define NF_EVERY_FIELD(F) \
  F(Float, a) F(Vec2, b) F(Vec3, c) F(Vec4, d) F(UVec2, e) F(IVec2, f) F(Uint, g) F(Mat4, h) F(Bool, i) F(Int, j)
NF_DECLARE_BLOCK(EveryBlock, "every", NF_EVERY_FIELD)

class ParamsTest : public testing::Test {
 protected:
  BlurParams blur;
  GlowParams glow;
  const ParamBlock blocks[2] = {{&BlurParams::table(), &blur}, {&GlowParams::table(), &glow}};

  // The exit code and text of what assigning throws.
  static std::pair<Exit, std::string> error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& e) {
      return {e.exit(), e.what()};
    }
    return {Exit::Ok, "nothing was thrown"};
  }
  std::pair<Exit, std::string> assign_error(std::string_view text) const {
    return error_of([&] { params::assign(blocks, text); });
  }
  std::pair<Exit, std::string> json_error(const json& values) const {
    return error_of([&] { params::from_json(blocks, values); });
  }
};

TEST_F(ParamsTest, StructHoldsTheDefaults) {
  EXPECT_EQ(blur.radius, 0.1f);
  EXPECT_EQ(blur.taps, 5);
  EXPECT_EQ(blur.edge_aware, 1u);
  EXPECT_EQ(blur.shape, 1);
  EXPECT_EQ(blur.sigma, 2.5f);
}

TEST_F(ParamsTest, TableIsTheStruct) {
  const ParamTable& table = BlurParams::table();
  ASSERT_EQ(table.params.size(), 5u);
  EXPECT_STREQ(table.prefix, "blur");
  EXPECT_EQ(table.size, sizeof(BlurParams));
  EXPECT_TRUE(table.editable);
  const size_t offsets[] = {offsetof(BlurParams, radius), offsetof(BlurParams, taps), offsetof(BlurParams, edge_aware),
                            offsetof(BlurParams, shape), offsetof(BlurParams, sigma)};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(table.params[i].offset, offsets[i]) << table.params[i].name;
    EXPECT_EQ(table.params[i].size, 4u);
  }
  EXPECT_STREQ(table.params[1].name, "taps");
  EXPECT_EQ(table.params[1].min, -3);
  EXPECT_EQ(table.params[1].max, 33);
  EXPECT_STREQ(table.params[0].unit, "px");
  EXPECT_STREQ(table.params[0].help, "Radius of the blur");
}

// C++ layout and GLSL scalar layout agree: members follow each other without padding.
TEST_F(ParamsTest, BlocksAreScalarLayout) {
  const ParamTable& table = EveryBlock::table();
  EXPECT_FALSE(table.editable);
  uint32_t expected = 0;
  for (const Param& p : table.params) {
    EXPECT_EQ(p.offset, expected) << p.name;
    expected += p.size;
  }
  EXPECT_EQ(expected, 4u + 8 + 12 + 16 + 8 + 8 + 4 + 64 + 4 + 4);
  EXPECT_EQ(table.size, expected);
}

TEST_F(ParamsTest, GlslTextIsTheTable) {
  EXPECT_EQ(params::glsl_block(BlurParams::table()),
            "layout(scalar) uniform blur_block {\n  float radius;\n  int taps;\n  uint edge_aware;\n  int shape;\n"
            "  float sigma;\n} blur;\n");
  EXPECT_EQ(
      params::glsl_block(EveryBlock::table()),
      "layout(scalar) uniform every_block {\n  float a;\n  vec2 b;\n  vec3 c;\n  vec4 d;\n  uvec2 e;\n  ivec2 f;\n"
      "  uint g;\n  mat4 h;\n  uint i;\n  int j;\n} every;\n");
}

TEST_F(ParamsTest, AssignTakesGoodValues) {
  for (const char* text :
       {"blur.radius=3.25", "blur.taps=-3", "blur.edge_aware=off", "blur.shape=tent", "blur.sigma=8", "glow.gain=0"})
    params::assign(blocks, text);
  EXPECT_EQ(blur.radius, 3.25f);
  EXPECT_EQ(blur.taps, -3);
  EXPECT_EQ(blur.edge_aware, 0u);
  EXPECT_EQ(blur.shape, 2);
  EXPECT_EQ(blur.sigma, 8.0f);
  EXPECT_EQ(glow.gain, 0.0f);
  for (const char* text : {"true", "1", "on"}) {
    params::assign(blocks, "blur.edge_aware=false");
    EXPECT_EQ(blur.edge_aware, 0u);
    params::assign(blocks, fmt::format("blur.edge_aware={}", text));
    EXPECT_EQ(blur.edge_aware, 1u);
  }
  params::assign(blocks, "blur.taps=2e1");  // a whole number, however it is written
  EXPECT_EQ(blur.taps, 20);
}

TEST_F(ParamsTest, UnknownIdNamesTheNearest) {
  for (const auto& [id, nearest] : {std::pair{"blur.radios", "'blur.radius'"},
                                    {"blr.taps", "'blur.taps'"},
                                    {"glow.gian", "'glow.gain'"},
                                    {"radius", "'blur.radius'"}}) {
    const auto [exit, text] = assign_error(fmt::format("{}=1", id));
    EXPECT_EQ(exit, Exit::Input) << id;
    EXPECT_NE(text.find(nearest), std::string::npos) << text;
    EXPECT_NE(text.find(id), std::string::npos) << text;
  }
}

TEST_F(ParamsTest, BadValuesAreUsageErrorsAndChangeNothing) {
  const BlurParams before = blur;
  for (const char* text : {"blur.radius",
                           "blur.radius=",
                           "=2",
                           "",
                           "blur.radius=wide",
                           "blur.radius=2px",
                           "blur.radius= 2",
                           "blur.radius=nan",
                           "blur.radius=inf",
                           "blur.radius=1e999",
                           "blur.radius=-0.01",
                           "blur.radius=16.5",
                           "blur.taps=2.5",
                           "blur.taps=34",
                           "blur.taps=-4",
                           "blur.taps=99999999999",
                           "blur.edge_aware=2",
                           "blur.edge_aware=True",
                           "blur.shape=round",
                           "blur.shape=1",
                           "blur.shape=",
                           "blur.shape=box|gauss"}) {
    const auto [exit, message] = assign_error(text);
    EXPECT_EQ(exit, Exit::Usage) << text << ": " << message;
    EXPECT_FALSE(message.empty());
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_EQ(std::memcmp(&before, &blur, sizeof blur), 0);
  EXPECT_NE(assign_error("blur.radius=20").second.find("0 to 16"), std::string::npos);
  EXPECT_NE(assign_error("blur.shape=round").second.find("box, gauss, tent"), std::string::npos);
}

TEST_F(ParamsTest, JsonHoldsWhatChanged) {
  EXPECT_EQ(params::to_json(blocks), json::object());
  params::assign(blocks, "blur.radius=0.3");
  params::assign(blocks, "blur.shape=box");
  params::assign(blocks, "glow.gain=2");
  EXPECT_EQ(params::to_json(blocks), json({{"blur.radius", 0.3}, {"blur.shape", "box"}, {"glow.gain", 2.0}}));
  const json all = params::to_json(blocks, true);
  EXPECT_EQ(all, json({{"blur.radius", 0.3},
                       {"blur.taps", 5},
                       {"blur.edge_aware", true},
                       {"blur.shape", "box"},
                       {"blur.sigma", 2.5},
                       {"glow.gain", 2.0}}));
  EXPECT_TRUE(all["blur.taps"].is_number_integer());
  EXPECT_TRUE(all["blur.edge_aware"].is_boolean());
}

TEST_F(ParamsTest, JsonRoundTrip) {
  for (const char* text : {"blur.radius=0.123456789", "blur.taps=7", "blur.edge_aware=0", "blur.shape=tent"})
    params::assign(blocks, text);
  for (const bool all : {false, true}) {
    const json written = json::parse(params::to_json(blocks, all).dump());
    BlurParams other_blur;
    GlowParams other_glow;
    const ParamBlock others[] = {{&BlurParams::table(), &other_blur}, {&GlowParams::table(), &other_glow}};
    params::from_json(others, written);
    EXPECT_EQ(std::memcmp(&blur, &other_blur, sizeof blur), 0);
    EXPECT_EQ(std::memcmp(&glow, &other_glow, sizeof glow), 0);
  }
  params::from_json(blocks, {{"blur.radius", "4"}});  // as on the command line
  EXPECT_EQ(blur.radius, 4.0f);
}

TEST_F(ParamsTest, JsonOfAWrongKind) {
  for (const json& values :
       {json{{"blur.radius", true}}, json{{"blur.radius", nullptr}}, json{{"blur.radius", json::array()}},
        json{{"blur.edge_aware", 1}}, json{{"blur.shape", 1}}, json{{"blur.taps", 2.5}}, json{{"blur.taps", 100}},
        json{{"blur.radius", "wide"}}, json{{"blur.radius", -1}}}) {
    const auto [exit, text] = json_error(values);
    EXPECT_EQ(exit, Exit::Usage) << values;
    EXPECT_NE(text.find(values.begin().key()), std::string::npos) << text;
  }
  EXPECT_EQ(json_error({{"blur.width", 1}}).first, Exit::Input);
  EXPECT_EQ(json_error(json::array({1})).first, Exit::Input);
  EXPECT_EQ(json_error("blur.radius=1").first, Exit::Input);
}

TEST_F(ParamsTest, ResetRestoresTheDefaults) {
  for (const char* text : {"blur.radius=9", "blur.taps=1", "blur.edge_aware=0", "blur.shape=box", "blur.sigma=1"})
    params::assign(blocks, text);
  params::reset(blocks[0]);
  const BlurParams fresh;
  EXPECT_EQ(std::memcmp(&fresh, &blur, sizeof blur), 0);
}

TEST_F(ParamsTest, FormatIsWhatAssignReads) {
  const auto rows = BlurParams::table().params;
  EXPECT_EQ(params::format(rows[0], 0.1f), "0.1");
  EXPECT_EQ(params::format(rows[0], rows[0].default_value), "0.1");
  EXPECT_EQ(params::format(rows[1], -3), "-3");
  EXPECT_EQ(params::format(rows[2], 1), "true");
  EXPECT_EQ(params::format(rows[2], 0), "false");
  EXPECT_EQ(params::format(rows[3], 2), "tent");
  EXPECT_EQ(params::choice_name(rows[3], 0), "box");
  params::assign(blocks, "blur.radius=0.7");
  for (const Param& row : rows) {
    const double value = params::get(BlurParams::table(), &blur, row);
    params::assign(blocks, fmt::format("blur.{}={}", row.name, params::format(row, value)));
    EXPECT_EQ(params::get(BlurParams::table(), &blur, row), value) << row.name;
  }
}

TEST(ErrorTest, CarriesExitCodeAndText) {
  try {
    fail(Exit::Output, "cannot write '{}': {}", "a.png", 7);
    FAIL() << "fail() returned";
  } catch (const Error& e) {
    EXPECT_EQ(e.exit(), Exit::Output);
    EXPECT_STREQ(e.what(), "cannot write 'a.png': 7");
  }
  EXPECT_THROW(throw Error(Exit::Gpu, "lost"), std::runtime_error);
}

// The numbers are a contract with shell scripts.
TEST(ErrorTest, ExitCodes) {
  const std::pair<Exit, int> codes[] = {
      {Exit::Ok, 0},     {Exit::CheckFailed, 1}, {Exit::Usage, 2},  {Exit::Input, 3},     {Exit::NoDevice, 4},
      {Exit::Shader, 5}, {Exit::Gpu, 6},         {Exit::Output, 7}, {Exit::Internal, 70}, {Exit::Interrupted, 130}};
  for (const auto& [code, number] : codes) EXPECT_EQ(int(code), number);
}

TEST(DoingTest, Nests) {
  EXPECT_EQ(Doing::current(), "");
  {
    const Doing outer("reading a.glb");
    EXPECT_EQ(Doing::current(), "reading a.glb");
    {
      const Doing inner("decoding image 3");
      EXPECT_EQ(Doing::current(), "decoding image 3");
    }
    EXPECT_EQ(Doing::current(), "reading a.glb");
    try {
      const Doing inner("throwing");
      fail(Exit::Input, "bad");
    } catch (const Error&) {
      EXPECT_EQ(Doing::current(), "reading a.glb");
    }
  }
  EXPECT_EQ(Doing::current(), "");
}

TEST(CheckDeathTest, SaysWhatWhereAndDuringWhat) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  int evaluated = 0;
  NF_CHECK(++evaluated == 1, "{} times", evaluated);
  EXPECT_EQ(evaluated, 1);

  const int have = 3, want = 4;
  EXPECT_DEATH(NF_CHECK(have == want, "{} and {}", have, want),
               "internal error: have == want \\(3 and 4\\) at .*core_test\\.cpp:[0-9]+\n");
  EXPECT_DEATH(
      {
        const Doing doing("recording the pass blur");
        NF_CHECK(have > want, "{}", have);
      },
      "have > want \\(3\\) at .*core_test\\.cpp:[0-9]+ while recording the pass blur");
  const BlurParams params;
  EXPECT_DEATH(params::get(EveryBlock::table(), &params, EveryBlock::table().params[1]), "every has no scalar values");
}

}  // namespace
}  // namespace nf
