#include "scenes/golden.hpp"
#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {

static std::string_view text_of(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

/// Every line ends with LF alone.
static std::string with_plain_ends(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] != '\r' || i + 1 == text.size() || text[i + 1] != '\n') plain += text[i];
  return plain;
}

void run_golden(Input input) {
  const std::string_view text = text_of(input);
  const scenes::ParsedGolden parsed = scenes::parse_golden(text);
  if (!parsed.file) {
    if (parsed.mistake.reason.empty()) fail("a golden file is refused without a reason");
    if (parsed.mistake.line < 1) fail("a mistake is in no line");
    return;
  }
  // One content has one text, so that whoever compares two files by eye is right.
  if (scenes::to_golden_text(*parsed.file) != with_plain_ends(text))
    fail("a golden file is another one when written");
}

std::vector<Seed> golden_seeds() {
  scenes::GoldenFile file;
  file.solver_version = 10;
  file.scenes.push_back({"stack-10", 600, 0xa1, 0xb2, {{1, 7, 90, 11, 0}, {600, 8, 91, 12, 0}}, 0});
  const std::string one = scenes::to_golden_text(file);
  file.scenes.push_back({"own/scene.json", 10, 0xc3, 0xd4, {{10, 9, 1 << 20, 13, 0}}, 0});
  const std::string two = scenes::to_golden_text(file);
  std::vector<Seed> seeds;
  for (const std::string& text : {one, two}) {
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    seeds.emplace_back(begin, begin + text.size());
  }
  return seeds;
}

}  // namespace cycloid::fuzz
