#include <algorithm>
#include <charconv>
#include <map>

#include "scenes/golden.hpp"

namespace cycloid::scenes {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::string_view kDigits = "0123456789abcdef";

std::string hex_word(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = text.size(); i-- > 0; value >>= 4) text[i] = kDigits[value & 15];
  return text;
}

/// Words are parted by single spaces, so a name's own blanks are written as %20 and the like.
bool is_plain(char c) {
  return c > ' ' && c != '%' && c != '\x7f';
}

std::string escaped(std::string_view name) {
  std::string word;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (is_plain(c) || byte >= 0x80) {
      word += c;
    } else {
      word += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return word;
}

std::optional<std::uint64_t> hexadecimal(std::string_view word, std::size_t size) {
  if (word.size() != size || word.find_first_not_of(kDigits) != word.npos) return std::nullopt;
  std::uint64_t value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value, 16);
  return value;
}

/// Nothing where the word is not what `escaped` makes of some name.
std::optional<std::string> unescaped(std::string_view word) {
  std::string name;
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (word[i] != '%') {
      name += word[i];
      continue;
    }
    const auto byte = hexadecimal(word.substr(std::min(i + 1, word.size()), 2), 2);
    if (!byte) return std::nullopt;
    name += static_cast<char>(*byte);
    i += 2;
  }
  if (name.empty() || escaped(name) != word) return std::nullopt;
  return name;
}

std::optional<std::uint64_t> decimal(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = error == std::errc() && end == word.data() + word.size();
  if (!whole || std::to_string(value) != word) return std::nullopt;
  return value;
}

Words words_of(std::string_view line) {
  Words words;
  for (;;) {
    const std::size_t space = line.find(' ');
    words.push_back(line.substr(0, space));
    if (space == line.npos) return words;
    line.remove_prefix(space + 1);
  }
}

/// The words where there are so many, else as many empty ones, which are nothing's spelling.
Words exactly(const Words& words, std::size_t count) {
  return words.size() == count ? words : Words(count);
}

/// Takes the lines one by one; each `take` returns why it does not, or "".
class GoldenReader {
 public:
  std::string take(std::string_view text) {
    const Words words = words_of(text);
    if (file_.solver_version == 0) return take_version(words);
    if (words[0] == "scene") return take_scene(words);
    return take_row(words);
  }

  /// What is missing at the end.
  std::string missing() const {
    if (file_.solver_version == 0) return "the line 'solver-version N' is missing";
    if (file_.scenes.empty()) return "there is no scene";
    for (const GoldenScene& scene : file_.scenes) {
      if (scene.rows.empty() || scene.rows.back().tick != scene.ticks)
        return "the row '" + escaped(scene.name) + " " + std::to_string(scene.ticks) +
               " ...' is missing";
    }
    return "";
  }
  GoldenFile& file() { return file_; }
  int line = 2;  ///< Of the next line.

 private:
  std::string take_version(const Words& given) {
    const Words words = exactly(given, 2);
    const auto version = decimal(words[1]);
    if (words[0] != "solver-version" || !version || *version == 0 || *version > UINT32_MAX)
      return "the second line must be 'solver-version N'";
    file_.solver_version = static_cast<std::uint32_t>(*version);
    return "";
  }

  std::string take_scene(const Words& given) {
    if (in_rows_) return "a scene must be named before the first row";
    GoldenScene scene;
    scene.line = line;
    const Words words = exactly(given, 5);
    const auto name = unescaped(words[1]);
    const auto ticks = decimal(words[2]);
    const auto digest = hexadecimal(words[3], 16);
    const auto inputs = hexadecimal(words[4], 16);
    if (!name || !ticks || *ticks == 0 || !digest || !inputs)
      return "a scene must be 'scene NAME TICKS SCENE-DIGEST INPUTS-DIGEST'";
    if (*ticks > kGoldenTicksMax)
      return "the scene '" + *name + "' has " + std::to_string(*ticks) + " ticks, at most " +
             std::to_string(kGoldenTicksMax) + " are read";
    if (!places_.emplace(*name, file_.scenes.size()).second)
      return "the scene '" + *name + "' is there twice";
    scene.name = *name;
    scene.ticks = *ticks;
    scene.scene_digest = *digest;
    scene.inputs_digest = *inputs;
    file_.scenes.push_back(std::move(scene));
    return "";
  }

  std::string take_row(const Words& given) {
    in_rows_ = true;
    GoldenRow row;
    row.line = line;
    const Words words = exactly(given, 5);
    const auto name = unescaped(words[0]);
    const auto tick = decimal(words[1]);
    const auto digest = hexadecimal(words[2], 16);
    const auto bytes = decimal(words[3]);
    const auto chain = hexadecimal(words[4], 16);
    if (!name || !tick || !digest || !bytes || !chain)
      return "a row must be 'NAME TICK DIGEST ENCODED-BYTES CHAIN'";
    const auto place = places_.find(*name);
    if (place == places_.end()) return "there is no line 'scene " + *name + " ...'";
    if (place->second < scene_)
      return "the rows of '" + *name + "' must stand together, in the order of the scenes";
    scene_ = place->second;
    GoldenScene& scene = file_.scenes[scene_];
    const std::uint64_t before = scene.rows.empty() ? 0 : scene.rows.back().tick;
    if (*tick <= before || *tick > scene.ticks)
      return "tick " + std::to_string(*tick) + " of '" + *name + "' is not in " +
             std::to_string(before + 1) + " to " + std::to_string(scene.ticks);
    row.tick = *tick;
    row.digest = *digest;
    row.encoded_bytes = *bytes;
    row.chain = *chain;
    scene.rows.push_back(row);
    return "";
  }

  GoldenFile file_;
  std::map<std::string, std::size_t> places_;
  std::size_t scene_ = 0;  ///< Of the last row.
  bool in_rows_ = false;
};

/// The next line without its end, which may be CR LF; nothing where no line ends.
std::optional<std::string_view> next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == text.npos) return std::nullopt;
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

std::string to_golden_text(const GoldenFile& file) {
  std::string text = "cycloid-golden " + std::to_string(kGoldenFormat) + "\nsolver-version " +
                     std::to_string(file.solver_version) + "\n";
  for (const GoldenScene& scene : file.scenes) {
    text += "scene " + escaped(scene.name) + " " + std::to_string(scene.ticks) + " " +
            hex_word(scene.scene_digest) + " " + hex_word(scene.inputs_digest) + "\n";
  }
  for (const GoldenScene& scene : file.scenes) {
    for (const GoldenRow& row : scene.rows) {
      text += escaped(scene.name) + " " + std::to_string(row.tick) + " " + hex_word(row.digest) +
              " " + std::to_string(row.encoded_bytes) + " " + hex_word(row.chain) + "\n";
    }
  }
  return text;
}

ParsedGolden parse_golden(std::string_view text) {
  const auto first = next_line(text);
  const Words head = exactly(words_of(first.value_or("")), 2);
  const auto format = decimal(head[1]);
  if (head[0] != "cycloid-golden" || !format)
    return {std::nullopt,
            {1, "is no golden file: it does not begin with the line 'cycloid-golden 1'", false}};
  if (*format != kGoldenFormat)
    return {std::nullopt,
            {1,
             "the file is of format " + std::to_string(*format) + ", this program reads " +
                 std::to_string(kGoldenFormat),
             true}};
  GoldenReader reader;
  while (!text.empty()) {
    const auto line = next_line(text);
    const std::string reason = line ? reader.take(*line) : "the line does not end: the file is cut";
    if (!reason.empty()) return {std::nullopt, {reader.line, reason, false}};
    ++reader.line;
  }
  if (const std::string missing = reader.missing(); !missing.empty())
    return {std::nullopt, {reader.line, missing, false}};
  return {std::move(reader.file()), {}};
}

std::string mismatch_text(const GoldenMismatch& mismatch) {
  const GoldenRow& expected = mismatch.expected;
  const GoldenRow& found = mismatch.found;
  std::string text = "tick " + std::to_string(expected.tick) + ": expected ";
  if (!mismatch.fault.ok()) {
    text += "digest " + hex_word(expected.digest) + ", found a world that does not step to tick " +
            std::to_string(mismatch.last) + ": " + solver::code_name(mismatch.fault.code) + " " +
            mismatch.fault.field;
  } else if (expected.digest != found.digest) {
    text += "digest " + hex_word(expected.digest) + ", found " + hex_word(found.digest);
  } else if (expected.encoded_bytes != found.encoded_bytes) {
    text += std::to_string(expected.encoded_bytes) + " encoded bytes, found " +
            std::to_string(found.encoded_bytes);
  } else {  // The worlds met again: only the ticks between the rows tell.
    text += "chain " + hex_word(expected.chain) + ", found " + hex_word(found.chain);
  }
  text += "; the first difference is in ";
  if (mismatch.first == mismatch.last) return text + "tick " + std::to_string(mismatch.last);
  return text + "ticks " + std::to_string(mismatch.first) + " to " + std::to_string(mismatch.last);
}

}  // namespace cycloid::scenes
