#include "bench/tuning/asked_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/catalogue.hpp"

namespace cycloid::tuning {
namespace {

TEST(AskedErrors, AreLengthsOrShares) {
  struct Read {
    const char* text;
    double length_m;
    double percent;
    const char* again;
  };
  const Read reads[] = {{"1mm", 0.001, 0.0, "1 mm"},       {"0.5cm", 0.005, 0.0, "5 mm"},
                        {"0.002m", 0.002, 0.0, "2 mm"},    {"2e-3m", 0.002, 0.0, "2 mm"},
                        {"1000m", 1000.0, 0.0, "1e+03 m"}, {"1%", 0.0, 1.0, "1 %"},
                        {"0.25%", 0.0, 0.25, "0.25 %"},    {"100%", 0.0, 100.0, "100 %"}};
  for (const Read& read : reads) {
    std::string mistake;
    const std::optional<AskedError> asked = read_asked_error(read.text, mistake);
    ASSERT_TRUE(asked) << read.text << ": " << mistake;
    EXPECT_DOUBLE_EQ(asked->length_m, read.length_m) << read.text;
    EXPECT_DOUBLE_EQ(asked->percent, read.percent) << read.text;
    EXPECT_EQ(text_of(*asked), read.again);
  }
}

TEST(AskedErrors, AnythingElseIsRefusedWithAReason) {
  struct BadText {
    const char* text;
    const char* reason;
  };
  const BadText bad_texts[] = {
      {"", "no number"},       {"mm", "no number"},    {"1", "has no unit"},
      {"1 mm", "not known"},   {"1km", "not known"},   {"1MM", "not known"},
      {"1mmm", "not known"},   {"-1mm", "above 0"},    {"0mm", "above 0"},
      {"0%", "above 0"},       {"101%", "at most"},    {"1001m", "at most"},
      {"1e999m", "no number"}, {"nanm", "no number"},  {"0x1mm", "not known"},
      {"1,5mm", "not known"},  {"--1mm", "no number"}, {"1..2mm", "no number"},
      {"1mm%", "not known"},   {"infm", "no number"}};
  for (const BadText& bad : bad_texts) {
    std::string mistake;
    EXPECT_FALSE(read_asked_error(bad.text, mistake)) << bad.text;
    EXPECT_THAT(mistake, testing::HasSubstr(bad.reason)) << bad.text;
    EXPECT_THAT(mistake, testing::HasSubstr("1mm, 0.5cm")) << bad.text;
  }
}

/// Goal: the size of the median body. Method: balls of known diameters, and a card of 400 x 2 mm.
TEST(TypicalSize, IsThatOfTheMiddleBody) {
  const auto size_of = [](const std::string& bodies) {
    const scenes::Loaded loaded = scenes::from_json("{\"bodies\": [" + bodies + "]}");
    EXPECT_TRUE(loaded.scene) << bodies;
    return typical_size_m(*loaded.scene);
  };
  const std::string floor = R"({"kind": "static", "shapes": [{"radius": 50}]})";
  EXPECT_EQ(size_of(floor), 0.0);
  EXPECT_NEAR(size_of(floor + R"(, {"shapes": [{"radius": 0.5}]})"), 1.0, 1.0e-6);
  EXPECT_NEAR(size_of(R"({"shapes": [{"radius": 0.5}]}, {"shapes": [{"radius": 8}]},
                             {"position": [9], "shapes": [{"radius": 0.1}]})"),
              1.0, 1.0e-6);
  EXPECT_NEAR(size_of(R"({"shapes": [{"kind": "polygon",
                        "points": [[-0.2, -0.001], [0.2, -0.001], [0.2, 0.001],
                                   [-0.2, 0.001]]}]})"),
              0.0283, 1.0e-4);
  const scenes::Scene ball =
      *scenes::from_json(R"({"bodies": [{"shapes": [{"radius": 0.5}]}]})").scene;
  EXPECT_NEAR(error_of({0.0, 1.0}, ball), 0.01, 1.0e-6);
  EXPECT_NEAR(error_of({0.002, 0.0}, ball), 0.002, 1.0e-6);
}

}  // namespace
}  // namespace cycloid::tuning
