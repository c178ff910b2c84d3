#include "scenes/golden.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {
namespace {

using testing::HasSubstr;

/// Two scenes, of which one has a name that has to be escaped.
GoldenFile example() {
  GoldenFile file;
  file.solver_version = 7;
  file.scenes.push_back({"half-pipe", 10, 0x1, 0x2, {{1, 0xa, 100, 0xb}, {10, 0xc, 90, 0xd}}});
  file.scenes.push_back({"scenes/my 50%.json", 1, 0x3, 0x4, {{1, 0xe, 80, 0xf}}});
  return file;
}

const char* const kExample =
    "cycloid-golden 1\n"
    "solver-version 7\n"
    "scene half-pipe 10 0000000000000001 0000000000000002\n"
    "scene scenes/my%2050%25.json 1 0000000000000003 0000000000000004\n"
    "half-pipe 1 000000000000000a 100 000000000000000b\n"
    "half-pipe 10 000000000000000c 90 000000000000000d\n"
    "scenes/my%2050%25.json 1 000000000000000e 80 000000000000000f\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Golden, IsWrittenAsALinePerSceneAndRow) {
  EXPECT_EQ(to_golden_text(example()), kExample);
}

TEST(Golden, IsReadAsItWasWritten) {
  const ParsedGolden parsed = parse_golden(kExample);
  ASSERT_TRUE(parsed.file) << parsed.mistake.reason;
  EXPECT_EQ(to_golden_text(*parsed.file), kExample);
  EXPECT_EQ(parsed.file->scenes[1].name, "scenes/my 50%.json");
  EXPECT_EQ(parsed.file->scenes[1].line, 4);
  EXPECT_EQ(parsed.file->scenes[0].rows[1].line, 6);
}

TEST(Golden, MayHaveTheLineEndsOfWindows) {
  std::string text;
  for (const char* c = kExample; *c != '\0'; ++c) text += *c == '\n' ? "\r\n" : std::string(1, *c);
  const ParsedGolden parsed = parse_golden(text);
  ASSERT_TRUE(parsed.file) << parsed.mistake.reason;
  EXPECT_EQ(to_golden_text(*parsed.file), kExample);
}

TEST(Golden, EveryMistakeIsNamedWithItsLine) {
  struct Case {
    std::string text;
    int line;
    const char* words;
  };
  const std::string good = kExample;
  const std::string row = "half-pipe 10 000000000000000c 90 000000000000000d\n";
  const Case cases[] = {
      {"", 1, "is no golden file"},
      {"arch-3d 1 55112038a3f6eb51\n", 1, "is no golden file"},
      {"cycloid-golden\n", 1, "is no golden file"},
      {"cycloid-golden 1", 1, "is no golden file"},
      {"cycloid-golden 1\n", 2, "solver-version"},
      {"cycloid-golden 1\nsolver-version 7\n", 3, "no scene"},
      {replaced(good, "solver-version 7", "solver-version 0"), 2, "solver-version N"},
      {replaced(good, "solver-version 7", "solver-version 4294967296"), 2, "solver-version N"},
      {replaced(good, "solver-version", "Solver-version"), 2, "solver-version N"},
      {replaced(good, "half-pipe 10 ", "half-pipe 0 "), 3, "scene NAME TICKS"},
      {replaced(good, "half-pipe 10 ", "half-pipe 100000001 "), 3, "has 100000001 ticks, at most"},
      {replaced(good, "half-pipe 10 ", "half-pipe 10  "), 3, "scene NAME TICKS"},
      {replaced(good, "0000000000000001", "000000000000001"), 3, "scene NAME TICKS"},
      {replaced(good, "0000000000000002", "000000000000000G"), 3, "scene NAME TICKS"},
      {replaced(good, "scene scenes/my%2050%25.json", "scene half-pipe"), 4, "is there twice"},
      {replaced(good, "my%2050%25.json", "my%2050%.json"), 4, "scene NAME TICKS"},
      {replaced(good, "my%2050%25.json", "m%795.json"), 4, "scene NAME TICKS"},
      {replaced(good, "half-pipe 1 ", "half-pipe 01 "), 5, "NAME TICK DIGEST"},
      {replaced(good, "half-pipe 1 ", "half-pipe +1 "), 5, "NAME TICK DIGEST"},
      {replaced(good, "half-pipe 1 ", "half-pip 1 "), 5, "there is no line 'scene half-pip"},
      {replaced(good, "half-pipe 1 ", "half-pipe 0 "), 5,
       "tick 0 of 'half-pipe' is not in 1 to 10"},
      {replaced(good, "000000000000000a", "000000000000000A"), 5, "NAME TICK DIGEST"},
      {replaced(good, " 100 ", " -1 "), 5, "NAME TICK DIGEST"},
      {replaced(good, " 100 ", " 18446744073709551616 "), 5, "NAME TICK DIGEST"},
      {replaced(good, "000000000000000b", "000000000000000b "), 5, "NAME TICK DIGEST"},
      {replaced(good, "half-pipe 10 000000000000000c", "half-pipe 1 000000000000000c"), 6,
       "2 to 10"},
      {replaced(good, "half-pipe 10 000000000000000c", "half-pipe 11 000000000000000c"), 6,
       "2 to 10"},
      {replaced(good, row, "\n" + row), 6, "NAME TICK DIGEST"},
      {replaced(good, row, "") + row, 7, "must stand together"},
      {replaced(good, row, ""), 7, "the row 'half-pipe 10 ...' is missing"},
      {good + "scene top 1 0000000000000001 0000000000000002\n", 8, "named before the first row"},
      {good.substr(0, good.size() - 1), 7, "the file is cut"},
  };
  for (const Case& wrong : cases) {
    const ParsedGolden parsed = parse_golden(wrong.text);
    EXPECT_FALSE(parsed.file) << wrong.text;
    EXPECT_EQ(parsed.mistake.line, wrong.line) << parsed.mistake.reason << "\n" << wrong.text;
    EXPECT_THAT(parsed.mistake.reason, HasSubstr(wrong.words));
    EXPECT_FALSE(parsed.mistake.other_format);
  }
}

TEST(Golden, OfAnotherFormatSaysSo) {
  const ParsedGolden parsed = parse_golden(replaced(kExample, "golden 1", "golden 2"));
  EXPECT_FALSE(parsed.file);
  EXPECT_TRUE(parsed.mistake.other_format);
  EXPECT_THAT(parsed.mistake.reason, HasSubstr("format 2"));
}

// A prefix that counted as a whole file would check fewer ticks and say that all is well.
TEST(Golden, CutAnywhereIsRefused) {
  const std::string good = kExample;
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(parse_golden(good.substr(0, size)).file) << size;
}

TEST(Golden, LineLeftOutAnywhereIsRefusedUnlessItIsARowBetween) {
  const std::string good = kExample;
  for (std::size_t start = 0; start < good.size();) {
    const std::size_t end = good.find('\n', start) + 1;
    const bool between =
        good.compare(start, 12, "half-pipe 1 ") == 0;  // The chain covers its tick.
    const std::string left = good.substr(0, start) + good.substr(end);
    EXPECT_EQ(parse_golden(left).file.has_value(), between) << left;
    start = end;
  }
}

TEST(Golden, FoldIsXxh3OfLittleEndianWords) {
  EXPECT_EQ(fold(0, 0), 0xd0a66a65c7528968u);
  EXPECT_NE(fold(1, 2), fold(2, 1));
  EXPECT_NE(fold(0, 1), fold(0, 1ull << 56));
}

TEST(Golden, NamesOfTheCatalogueAreNoPaths) {
  for (const CatalogueEntry& entry : catalogue()) EXPECT_FALSE(is_path(entry.name)) << entry.name;
  EXPECT_FALSE(is_path("pyramid:base=100"));
  EXPECT_TRUE(is_path("mine.json"));
  EXPECT_TRUE(is_path("./mine"));
}

GoldenScene golden_of(const Scene& scene, const std::vector<std::uint64_t>& ticks) {
  GoldenWalk walk(scene, std::move(Simulation::create(scene).value()));
  GoldenScene golden;
  for (const std::uint64_t tick : ticks) golden.rows.push_back(walk.walk_to(tick).value());
  return golden;
}

std::optional<GoldenMismatch> compare(const GoldenScene& golden, const Scene& scene,
                                      std::uint64_t ticks_max = 1000) {
  GoldenWalk walk(scene, std::move(Simulation::create(scene).value()));
  return compare_golden(golden, walk, ticks_max);
}

TEST(GoldenWalk, ChainIsOfEveryDigestWhicheverRowsAreListed) {
  const Scene scene = *find("half-pipe").scene;
  const GoldenScene all = golden_of(scene, {1, 2, 3, 4, 5, 6});
  const GoldenScene some = golden_of(scene, {3, 6});
  std::uint64_t chain = kChainStart;
  for (const GoldenRow& row : all.rows) EXPECT_EQ(row.chain, chain = fold(chain, row.digest));
  EXPECT_EQ(some.rows[0].chain, all.rows[2].chain);
  EXPECT_EQ(some.rows[1].chain, all.rows[5].chain);
  EXPECT_EQ(some.rows[1].digest, all.rows[5].digest);
}

TEST(GoldenWalk, EveryChangedNumberOfARowIsFoundWithTheTicksBetween) {
  const Scene scene = *find("half-pipe").scene;
  const GoldenScene good = golden_of(scene, {2, 9});
  EXPECT_FALSE(compare(good, scene));
  GoldenScene digest = good;
  digest.rows[1].digest ^= 1;
  GoldenScene bytes = good;
  bytes.rows[1].encoded_bytes += 1;
  GoldenScene chain = good;
  chain.rows[1].chain ^= 1;
  const std::pair<GoldenScene, const char*> cases[] = {
      {digest, "tick 9: expected digest "}, {bytes, " encoded bytes, found "}, {chain, "chain "}};
  for (const auto& [wrong, words] : cases) {
    const auto mismatch = compare(wrong, scene);
    ASSERT_TRUE(mismatch) << words;
    EXPECT_EQ(mismatch->expected.tick, 9u);
    EXPECT_THAT(mismatch_text(*mismatch), HasSubstr(words));
    EXPECT_THAT(mismatch_text(*mismatch), HasSubstr("the first difference is in ticks 3 to 9"));
    EXPECT_FALSE(compare(wrong, scene, 8)) << "the row of tick 9 is behind 8";
  }
  GoldenScene early = good;
  early.rows[0].digest ^= 1;
  EXPECT_THAT(mismatch_text(*compare(early, scene)), HasSubstr("in ticks 1 to 2"));
}

TEST(GoldenWalk, InputsDigestChangesWithWhatTheScriptSaysUpToTheTick) {
  Scene scene = *find("half-pipe").scene;
  ASSERT_FALSE(scene.seats.empty());
  const std::uint64_t before = inputs_digest(scene, 50);
  ScriptEntry late;
  late.from = 51;
  late.buttons = 1;
  scene.seats[0].script.push_back(late);
  EXPECT_EQ(inputs_digest(scene, 50), before);
  EXPECT_NE(inputs_digest(scene, 51), inputs_digest(*find("half-pipe").scene, 51));
}

}  // namespace
}  // namespace cycloid::scenes
