#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "bench/figures/gnuplot.hpp"

namespace cycloid::figures {

static experiments::Figure sample() {
  experiments::Figure figure;
  figure.name = "sample";
  figure.title = "It's a title";
  figure.x_label = "x";
  figure.y_label = "y";
  figure.log_y = true;
  figure.curves = {{"first", {{1.0, 10.0}, {2.0, 100.0}}}, {"second", {{1.0, 3.0}}}};
  return figure;
}

static std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Figure, ScriptHoldsTheDataAndQuotesTheText) {
  const std::string script = gnuplot_script(sample(), "out.svg");
  EXPECT_NE(script.find("set title 'It''s a title'"), std::string::npos);
  EXPECT_NE(script.find("1 10\n2 100\n"), std::string::npos);
  EXPECT_NE(script.find("set logscale y"), std::string::npos);
  EXPECT_EQ(script.find("set logscale x"), std::string::npos);
  EXPECT_NE(script.find("title 'second'"), std::string::npos);
}

TEST(Figure, TextDoesNotLeaveItsQuotes) {
  experiments::Figure figure = sample();
  figure.title = "a\n!touch out\r\tb'\x7f";
  const std::string script = gnuplot_script(figure, "out.svg");
  EXPECT_NE(script.find("set title 'a !touch out  b'' '\n"), std::string::npos);
  EXPECT_EQ(script.find("\n!"), std::string::npos);
}

TEST(Figure, IsDrawnTheSameTwice) {
  const auto folder = std::filesystem::temp_directory_path() / "cycloid-figure-test";
  ASSERT_EQ(draw(sample(), folder.string()), "");
  const std::string first = text_of(folder / "sample.svg");
  ASSERT_EQ(draw(sample(), folder.string()), "");
  EXPECT_EQ(text_of(folder / "sample.svg"), first);
  EXPECT_NE(first.find("<svg"), std::string::npos);
  EXPECT_NE(first.find("It's a title"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(Figure, SaysWhyItCouldNotBeDrawn) {
  EXPECT_NE(draw(sample(), "/dev/null/folder"), "");
  const auto folder = std::filesystem::temp_directory_path() / "cycloid-figure\ntest";
  EXPECT_NE(draw(sample(), folder.string()).find("control characters"), std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace cycloid::figures
